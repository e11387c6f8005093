#include "corda/pipeline/provenance.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <zlib.h>
#include <nlohmann/json.hpp>

#include "corda/core/file.hpp"
#include "corda/core/markup.hpp"
#include "corda/core/text.hpp"
#include "corda/media/defs.hpp"
#include "corda/media/format/file_kind.hpp"
#include "corda/media/read/video_comment.hpp"
#include "corda/pipeline/film.hpp"
#include "corda/scene/write_scene.hpp"
#include "corda/view/font.hpp"

namespace corda {
namespace {

using Json = nlohmann::json;

/// Larger scenes are not even tried: most have more text than there is room for.
constexpr std::size_t kMaxParticles = 100'000;
constexpr std::size_t kMaxTimes = 1000;
constexpr std::size_t kMaxName = 255;
constexpr const char* kPacked = "packed_scenes";
/// Of the texts of all scenes of a file.
constexpr std::size_t kMaxUnpacked = std::size_t{1} << 20;

constexpr std::string_view kVideoRemedy =
    "give a video that corda render has written (.mp4, .mov, .mkv, .webm)";

std::string_view remedy(OriginUse use) {
    return use == OriginUse::kJoin
               ? kVideoRemedy
               : "give a PNG, or a video that is no animation, which a command of corda has written";
}

[[noreturn]] void fail_at(const std::string& path, const std::string& problem,
                          OriginUse use = OriginUse::kFrom) {
    throw_usage("'{}' {}; {}", path, problem, remedy(use));
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
    return json;
}

constexpr std::size_t kDigits = 16;  // of a double's bits

std::string hex_of(const std::vector<double>& values) {
    std::string text;
    text.reserve(values.size() * kDigits);
    for (const double value : values)
        fmt::format_to(std::back_inserter(text), "{:016x}", std::bit_cast<std::uint64_t>(value));
    return text;
}

std::vector<double> from_hex(std::string_view text) {
    std::vector<double> values;
    for (; !text.empty(); text.remove_prefix(kDigits)) {
        const auto bits = whole_number<std::uint64_t>(text.substr(0, kDigits), 16);
        values.push_back(std::bit_cast<double>(bits.value_or(0)));
        if (text.size() < kDigits || !bits || !std::isfinite(values.back()))
            throw Error(ExitCode::kUsage, "its positions are not what corda writes");
    }
    return values;
}

Json json_of(const GoldenRecord& golden) {
    Json json{{"renderer", golden.renderer},
              {"solver", golden.solver},
              {"center", {golden.center_m.x, golden.center_m.y}},
              {"height", golden.height_m},
              {"margin", golden.margin},
              {"state", golden.state},
              {"positions", hex_of(golden.positions_m)}};
    if (!golden.color_scale.empty()) json["color_scale"] = golden.color_scale;
    return json;
}

/// Throws what the JSON library throws for other types.
GoldenRecord golden_of(const Json& json) {
    const Json& center = json.at("center");
    GoldenRecord golden{.renderer = json.at("renderer").get<std::string>(),
                        .solver = json.at("solver").get<std::string>(),
                        .center_m = {center.at(0).get<double>(), center.at(1).get<double>()},
                        .height_m = json.at("height").get<double>(),
                        .margin = json.at("margin").get<double>(),
                        .color_scale = printable(json.value("color_scale", "")),
                        .state = json.at("state").get<std::string>(),
                        .positions_m = from_hex(json.at("positions").get<std::string>())};
    if (!golden.solver.starts_with("solver=")) throw Error(ExitCode::kUsage, "its solver is no setting");
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
    const bool is_known =
        picture.command == "still" || picture.command == "strobe" || picture.command == "sheet";
    const bool is_sound =
        is_known && !picture.times.empty() && picture.columns >= 0 && picture.columns <= 1000 &&
        picture.shutter >= 0.0 && picture.shutter <= 1.0 &&
        (!picture.pixels_per_inch || (*picture.pixels_per_inch > 0.0 && *picture.pixels_per_inch <= 10000.0));
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
    for (const Json& font : json.value("fonts", Json::array()))
        provenance.fonts.push_back(printable(font.get<std::string>()));
    if (json.contains("picture")) provenance.picture = picture_of(json["picture"]);
    if (json.contains("golden")) provenance.golden = golden_of(json["golden"]);
    for (const Json& part : json.value("parts", Json::array())) {
        provenance.parts.push_back(parsed(part));
        std::string& left_out = provenance.parts.back().left_out;
        if (left_out.empty()) left_out = provenance.left_out;
    }
    if (!is_sound_name(provenance.name)) throw Error(ExitCode::kUsage, "its name is none of a scene");
    return provenance;
}

/// Calls `visit` with the scene of a file and those of its parts.
template <class Made, class Visit>
void for_each_scene(Made& provenance, const Visit& visit) {
    visit(provenance.scene);
    for (auto& part : provenance.parts) for_each_scene(part, visit);
}

/// All scenes in base64 of a zlib stream, each with a NUL at its end.
std::string packed(const std::string& scenes) {
    uLongf size = compressBound(scenes.size());
    std::string bytes(size, '\0');
    if (compress2(reinterpret_cast<Bytef*>(bytes.data()), &size,
                  reinterpret_cast<const Bytef*>(scenes.data()), scenes.size(), Z_BEST_COMPRESSION) != Z_OK)
        throw std::bad_alloc();
    return base64({bytes.data(), size});
}

void unpack(const std::string& text, Provenance& provenance) {
    const std::string bytes = from_base64(text);
    std::string scenes(kMaxUnpacked, '\0');
    uLongf size = scenes.size();
    const bool is_sound = uncompress(reinterpret_cast<Bytef*>(scenes.data()), &size,
                                     reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()) == Z_OK;
    std::string_view rest(scenes.data(), is_sound ? size : 0);
    for_each_scene(provenance, [&rest](std::string& scene) {
        const std::size_t end = rest.find('\0');
        if (end == std::string_view::npos)
            throw Error(ExitCode::kUsage, "its packed scenes are not what corda writes");
        scene = rest.substr(0, end);
        rest.remove_prefix(end + 1);
    });
}

Provenance parsed(const std::string& text) {
    const Json json = media::parse_untrusted_json(text);
    Provenance provenance = parsed(json);
    if (json.contains(kPacked)) unpack(json[kPacked].get<std::string>(), provenance);
    return provenance;
}

Json json_of(const Provenance& provenance) {
    Json json{{"corda", provenance.corda}, {"name", provenance.name}};
    if (!provenance.scene.empty()) json["scene"] = provenance.scene;
    if (!provenance.left_out.empty()) json["left_out"] = provenance.left_out;
    if (!provenance.frames.empty()) json["frames"] = provenance.frames;
    if (!provenance.fonts.empty()) json["fonts"] = provenance.fonts;
    if (provenance.picture) json["picture"] = json_of(*provenance.picture);
    if (provenance.golden) json["golden"] = json_of(*provenance.golden);
    for (const Provenance& part : provenance.parts) json["parts"].push_back(json_of(part));
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

/// The names of parts as a sound name.
std::string names_of(const std::vector<Provenance>& parts) {
    std::string names;
    for (const Provenance& part : parts) {
        names += (names.empty() ? "" : ", ") + part.name;
        if (names.size() > kMaxName) break;
    }
    return shortened(std::move(names), kMaxName);
}

/// Refuses a file without a scene, and one with several.
void check_scene(const Provenance& provenance, const std::string& path) {
    if (!provenance.parts.empty())
        throw_usage("'{}' has several scenes ({}); give one of the videos that it was joined of", path,
                    printable(names_of(provenance.parts)));
    if (!provenance.scene.empty()) return;
    fail_at(path,
            fmt::format("does not carry its scene, because {}",
                        provenance.left_out.empty() ? "it is damaged" : printable(provenance.left_out)));
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

std::string text_in_video(const std::string& path, OriginUse use) {
    const std::string text = media::video_comment(path, remedy(use));
    Json comment = Json::parse(text, nullptr, false);  // its size and depth were checked
    if (!comment.is_object() || !comment.contains(kProvenanceKey)) return {};
    return comment[kProvenanceKey].dump();
}

}  // namespace

Provenance provenance_of(const Scene& scene) {
    Provenance provenance;
    provenance.corda = version();
    provenance.name = shortened(printable(scene.name), kMaxName);
    provenance.fonts = view::fallback_names(shown_texts(scene));
    std::size_t particles = 0;
    for (const RopeDef& rope : scene.ropes) particles += rope.points_m.size();
    for (const NetDef& net : scene.nets) particles += net.points_m.size();
    if (particles > kMaxParticles) {
        provenance.left_out =
            fmt::format("the scene has {} particles, more than {}", particles, kMaxParticles);
        return provenance;
    }
    try {
        provenance.scene = write_scene(scene);
    } catch (const Error& error) {
        provenance.left_out = utf8(error.what());
    }
    return provenance;
}

Provenance joined(const std::vector<Provenance>& videos) {
    std::vector<Provenance> parts;
    for (const Provenance& video : videos) {
        if (video.parts.empty())
            parts.push_back(video);
        else
            parts.insert(parts.end(), video.parts.begin(), video.parts.end());
    }
    return {.corda = std::string(version()), .name = names_of(parts), .parts = parts};
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
    std::string scenes;
    for_each_scene(provenance, [&scenes](std::string& scene) {
        (scenes += scene) += '\0';
        scene.clear();
    });
    Json json = json_of(provenance);
    const std::size_t others = std::min(text_of(json).size(), Provenance::kMaxBytes);
    const char* const subject = provenance.parts.empty() ? "the scene takes" : "the scenes take";
    if (scenes.size() > kMaxUnpacked) {
        provenance.left_out = fmt::format("{} {} bytes, more than {}", subject, scenes.size(), kMaxUnpacked);
    } else {
        json[kPacked] = packed(scenes);
        text = text_of(json);
        if (fits(text)) return text;
        provenance.left_out = fmt::format("{} {} compressed bytes, more than {}", subject,
                                          text.size() - others, Provenance::kMaxBytes - others);
    }
    text = text_of(json_of(provenance));
    if (fits(text)) return text;
    provenance.picture.reset();
    if (!provenance.parts.empty()) {
        provenance.left_out = fmt::format("the names of {} scenes take {} bytes, more than {}",
                                          provenance.parts.size(), text.size(), Provenance::kMaxBytes);
        provenance.parts.clear();
    }
    return text_of(json_of(provenance));
}

std::string font_change(const Provenance& provenance, const std::vector<std::string>& now) {
    if (provenance.fonts == now) return {};
    const auto words = [](const std::vector<std::string>& names) {
        return names.empty() ? std::string("none") : fmt::format("{}", fmt::join(names, ", "));
    };
    return fmt::format("other fonts besides DejaVu Sans: {}, now {}", words(provenance.fonts), words(now));
}

std::string left_out_of(const std::string& text) {
    std::vector<Provenance> all{parsed(text)};
    for (std::size_t i = 0; i < all.size(); ++i) {
        if (!all[i].left_out.empty()) return all[i].left_out;
        const std::vector<Provenance> parts = std::move(all[i].parts);
        all.insert(all.end(), parts.begin(), parts.end());
    }
    return "";
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

Provenance read_provenance(const std::string& path, OriginUse use) {
    if (path.ends_with(".toml"))
        throw_usage("'{}' is a scene file; {}", path,
                    use == OriginUse::kJoin ? kVideoRemedy : "give it without --from");
    const std::string kind = media::file_kind(path);
    if (kind == "gif") fail_at(path, "is a GIF, which carries no provenance", use);
    PngTexts png;
    if (media::is_png(path))
        png = texts_in(read_png_info(path));
    else
        png.provenance = text_in_video(path, use);
    const std::string& text = png.provenance;
    if (text.empty()) fail_at(path, "has no provenance", use);
    if (text.size() > 2 * Provenance::kMaxBytes) fail_at(path, "has more provenance than corda writes", use);
    Provenance provenance;
    try {
        provenance = parsed(text);
    } catch (const std::exception& error) {
        fail_at(path, fmt::format("has damaged provenance ({})", printable(error.what())), use);
    }
    if (!provenance.picture) provenance.picture = frame_of_sequence(png.frame);
    return provenance;
}

Scene scene_of(const Provenance& provenance, const std::string& path, const std::vector<Setting>& settings) {
    check_scene(provenance, path);
    Scene scene = parse_scene(provenance.scene, path, settings);
    scene.name = provenance.name;
    return scene;
}

}  // namespace corda
