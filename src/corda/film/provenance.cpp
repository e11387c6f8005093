#include "corda/film/provenance.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include <fmt/format.h>
#include <zlib.h>
#include <nlohmann/json.hpp>

#include "corda/core/file.hpp"
#include "corda/core/markup.hpp"
#include "corda/core/text.hpp"
#include "corda/film/film.hpp"
#include "corda/media/defs.hpp"
#include "corda/media/format/file_kind.hpp"
#include "corda/media/read/video_comment.hpp"
#include "corda/scene/write_scene.hpp"

namespace corda {
namespace {

using Json = nlohmann::json;

/// Larger scenes are not even tried: most have more text than there is room for.
constexpr std::size_t kMaxParticles = 100'000;
constexpr std::size_t kMaxTimes = 1000;
constexpr std::size_t kMaxName = 255;
constexpr const char* kPacked = "packed_scene";
constexpr std::size_t kMaxUnpacked = std::size_t{1} << 20;

constexpr const char* kRemedy =
    "give a PNG, or a video that is no animation, which a command of corda has written";

[[noreturn]] void fail_at(const std::string& path, const std::string& problem) {
    throw_usage("'{}' {}; {}", path, problem, kRemedy);
}

Json json_of(const PictureOrigin& picture) {
    Json times = Json::array();
    for (const PictureTime& time : picture.times)
        times.push_back(time.frame ? Json{{"frame", *time.frame}} : Json(time.time_s));
    Json json{{"command", picture.command}, {"times", times}};
    if (!picture.film_times_s.empty()) json["film_times"] = picture.film_times_s;
    if (picture.columns > 0) json["columns"] = picture.columns;
    if (picture.shutter > 0.0) json["shutter"] = picture.shutter;
    if (picture.pixels_per_inch) json["pixels_per_inch"] = *picture.pixels_per_inch;
    if (picture.font_pt) json["font_pt"] = *picture.font_pt;
    return json;
}

/// Throws what the JSON library throws for other types.
GoldenRecord golden_of(const Json& json) {
    GoldenRecord golden{.renderer = json.at("renderer").get<std::string>()};
    const Json chosen = json.value("chosen", Json::object());
    for (const auto& [key, value] : chosen.items())
        golden.chosen.emplace(printable(key), printable(value.get<std::string>()));
    return golden;
}

/// Throws what the JSON library throws for other types.
PictureOrigin picture_of(const Json& json) {
    PictureOrigin picture;
    picture.command = json.at("command").get<std::string>();
    for (const Json& time : json.at("times")) {
        if (time.is_object())
            picture.times.push_back({time.at("frame").get<std::int64_t>(), 0.0});
        else
            picture.times.push_back({std::nullopt, time.get<double>()});
    }
    if (json.contains("film_times")) picture.film_times_s = json["film_times"].get<std::vector<double>>();
    picture.columns = json.value("columns", 0);
    picture.shutter = json.value("shutter", 0.0);
    if (json.contains("pixels_per_inch")) picture.pixels_per_inch = json["pixels_per_inch"].get<double>();
    if (json.contains("font_pt")) picture.font_pt = json["font_pt"].get<double>();
    const bool is_known =
        picture.command == "still" || picture.command == "strobe" || picture.command == "sheet";
    const bool is_sound = is_known && !picture.times.empty() && picture.columns >= 0 &&
                          picture.columns <= 1000 && picture.shutter >= 0.0 && picture.shutter <= 1.0 &&
                          (!picture.pixels_per_inch ||
                           (*picture.pixels_per_inch > 0.0 && *picture.pixels_per_inch <= 10000.0)) &&
                          (!picture.font_pt || (*picture.font_pt >= 1.0 && *picture.font_pt <= 100.0));
    if (!is_sound) throw Error(ExitCode::kUsage, "its picture is not what corda writes");
    return picture;
}

/// Names of files are made of it.
bool is_sound_name(const std::string& name) {
    return !name.empty() && name.size() <= kMaxName && name != "." && name != ".." &&
           std::ranges::none_of(name,
                                [](char c) { return c == '/' || static_cast<unsigned char>(c) < 0x20; });
}

Provenance parsed(const Json& json) {
    Provenance provenance;
    provenance.corda = printable(json.at("corda").get<std::string>());
    provenance.name = json.at("name").get<std::string>();
    provenance.scene = json.value("scene", "");
    provenance.left_out = json.value("left_out", "");
    provenance.frames = json.value("frames", "");
    provenance.settings = json.value("settings", provenance.settings);
    if (json.contains("picture")) provenance.picture = picture_of(json["picture"]);
    if (json.contains("golden")) provenance.golden = golden_of(json["golden"]);
    if (!is_sound_name(provenance.name)) throw Error(ExitCode::kUsage, "its name is none of a scene");
    return provenance;
}

/// Base64 of a zlib stream.
std::string packed(const std::string& text) {
    uLongf size = compressBound(text.size());
    std::string bytes(size, '\0');
    if (compress2(reinterpret_cast<Bytef*>(bytes.data()), &size, reinterpret_cast<const Bytef*>(text.data()),
                  text.size(), Z_BEST_COMPRESSION) != Z_OK)
        throw std::bad_alloc();
    return base64({bytes.data(), size});
}

std::string unpacked(const std::string& text) {
    const std::string bytes = from_base64(text);
    std::string scene(kMaxUnpacked, '\0');
    uLongf size = scene.size();
    if (uncompress(reinterpret_cast<Bytef*>(scene.data()), &size,
                   reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()) != Z_OK)
        throw Error(ExitCode::kUsage, "its packed scene is not what corda writes");
    scene.resize(size);
    return scene;
}

Provenance parsed(const std::string& text) {
    const Json json = media::parse_untrusted_json(text);
    Provenance provenance = parsed(json);
    if (json.contains(kPacked)) provenance.scene = unpacked(json[kPacked].get<std::string>());
    return provenance;
}

Json json_of(const Provenance& provenance) {
    Json json{{"corda", provenance.corda}, {"name", provenance.name}};
    if (!provenance.scene.empty()) json["scene"] = provenance.scene;
    if (!provenance.settings.empty()) json["settings"] = provenance.settings;
    if (!provenance.left_out.empty()) json["left_out"] = provenance.left_out;
    if (!provenance.frames.empty()) json["frames"] = provenance.frames;
    if (provenance.picture) json["picture"] = json_of(*provenance.picture);
    if (provenance.golden)
        json["golden"] = {{"renderer", provenance.golden->renderer}, {"chosen", provenance.golden->chosen}};
    return json;
}

/// A text of at most `bytes`, which ends in "..." if it was longer.
std::string shortened(std::string text, std::size_t bytes) {
    constexpr std::string_view kMore = "...";
    if (text.size() <= bytes) return text;
    std::size_t end = bytes - kMore.size();
    while (end > 0 && is_continuation(text[end])) --end;
    return text.substr(0, end).append(kMore);
}

/// Provenance in the texts of a PNG.
struct PngTexts {
    std::string provenance;  ///< empty if there is none
    std::string frame;       ///< its number, in words
};

PngTexts texts_in(const PngInfo& info) {
    PngTexts texts;
    for (const auto& [keyword, text] : info.text) {
        if (keyword == kProvenanceKeyword) texts.provenance = text;
        if (keyword == "Frame") texts.frame = text;
    }
    return texts;
}

/// A picture of a sequence.
std::optional<PictureOrigin> frame_of_sequence(const std::string& number) {
    const auto frame = whole_number<std::int64_t>(number);
    if (!frame) return std::nullopt;
    return PictureOrigin{.command = "frame", .times = {{frame, 0.0}}};
}

std::string text_in_video(const std::string& path) {
    const std::string text = media::video_comment(path, kRemedy);
    Json comment = Json::parse(text, nullptr, false);  // its size and depth were checked
    if (!comment.is_object() || !comment.contains(kProvenanceKey)) return {};
    return comment[kProvenanceKey].dump();
}

/// Whether the text of a scene gives all its values: code may have changed them since it was read.
bool is_as_written(const Scene& scene) {
    return !scene.text.empty() &&
           values_of(parse_scene(scene.text, scene.source, scene.settings)) == values_of(scene);
}

/// Tells pictures of other scenes and positions apart. The encoder's threads change none.
std::string hash_of(const Scene& scene) {
    std::string text = scene.given->hash();
    for (const auto& [key, value] : values_of(scene))
        if (key != "video.threads") text += fmt::format("\n{} = {}", key, value);
    return hash_text(text);
}

}  // namespace

Provenance provenance_of(const Scene& scene) {
    Provenance provenance;
    provenance.corda = version();
    provenance.name = shortened(printable(scene.name), kMaxName);
    if (!is_sound_name(provenance.name)) provenance.name = "scene";  // of a scene that code has filled in
    if (scene.given) {
        provenance.left_out = fmt::format(
            "its positions were given and not simulated (hash of scene and positions: {})", hash_of(scene));
        return provenance;
    }
    std::size_t particles = 0;
    for (const RopeDef& rope : scene.ropes) particles += rope.points_m.size();
    for (const NetDef& net : scene.nets) particles += net.points_m.size();
    if (particles > kMaxParticles) {
        provenance.left_out =
            fmt::format("the scene has {} particles, more than {}", particles, kMaxParticles);
        return provenance;
    }
    try {
        if (is_as_written(scene)) {
            provenance.scene = scene.text;
            std::ranges::copy_if(scene.settings, std::back_inserter(provenance.settings),
                                 [](const Setting& setting) { return !setting.starts_with("video.jobs"); });
        } else {
            provenance.scene = write_scene(scene);
        }
    } catch (const Error& error) {
        provenance.left_out = utf8(error.what());
    }
    return provenance;
}

std::string provenance_text(Provenance provenance) {
    constexpr std::size_t kMaxReason = 500;
    if (provenance.picture &&
        (provenance.picture->times.size() > kMaxTimes || provenance.picture->film_times_s.size() > kMaxTimes))
        provenance.picture.reset();
    const auto text_of = [](const Json& json) {
        return json.dump(-1, ' ', true, Json::error_handler_t::replace);
    };
    const auto fits = [](const std::string& text) { return text.size() <= Provenance::kMaxBytes; };
    provenance.left_out = shortened(provenance.left_out, kMaxReason);
    std::string text = text_of(json_of(provenance));
    if (fits(text)) return text;
    const std::string scene = std::exchange(provenance.scene, {});
    if (scene.size() > kMaxUnpacked) {
        provenance.left_out =
            fmt::format("the scene takes {} bytes, more than {}", scene.size(), kMaxUnpacked);
    } else {
        Json json = json_of(provenance);
        json[kPacked] = packed(scene);
        text = text_of(json);
        if (fits(text)) return text;
        provenance.left_out = fmt::format("the scene takes {} compressed bytes, and all may take {}",
                                          text.size(), Provenance::kMaxBytes);
    }
    provenance.settings.clear();
    text = text_of(json_of(provenance));
    if (fits(text)) return text;
    provenance.picture.reset();
    return text_of(json_of(provenance));
}

std::string left_out_of(const std::string& text) {
    return parsed(text).left_out;
}

Provenance provenance_in(const PngInfo& info) {
    const std::string text = texts_in(info).provenance;
    if (text.empty() || text.size() > Provenance::kMaxBytes) return {};
    try {
        return parsed(text);
    } catch (const std::exception&) {
        return {};
    }
}

Provenance read_provenance(const std::string& path) {
    if (path.ends_with(".toml")) throw_usage("'{}' is a scene file; give it without --from", path);
    const std::string kind = media::file_kind(path);
    if (kind == "gif") fail_at(path, "is a GIF, which carries no provenance");
    const media::ForeignKind* const foreign = media::foreign_kind_of(path);
    if (foreign != nullptr && foreign->remedy == media::kConvertToPng)
        fail_at(path, fmt::format("is {}, which carries no scene", foreign->words));
    PngTexts png;
    if (media::is_png(path))
        png = texts_in(read_png_info(path));
    else
        png.provenance = text_in_video(path);
    const std::string& text = png.provenance;
    if (text.empty()) fail_at(path, "has no provenance");
    if (text.size() > 2 * Provenance::kMaxBytes) fail_at(path, "has more provenance than corda writes");
    Provenance provenance;
    try {
        provenance = parsed(text);
    } catch (const std::exception& error) {
        fail_at(path, fmt::format("has damaged provenance ({})", printable(error.what())));
    }
    if (!provenance.picture) provenance.picture = frame_of_sequence(png.frame);
    return provenance;
}

Scene scene_of(const Provenance& provenance, const std::string& path, const std::vector<Setting>& settings) {
    if (provenance.scene.empty())
        fail_at(path,
                fmt::format("does not carry its scene, because {}",
                            provenance.left_out.empty() ? "it is damaged" : printable(provenance.left_out)));
    std::vector<Setting> all = provenance.settings;
    all.insert(all.end(), settings.begin(), settings.end());
    Scene scene = parse_scene(provenance.scene, path, all);
    scene.name = provenance.name;
    return scene;
}

}  // namespace corda
