#include "corda/media/format/format.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <filesystem>

#include "corda/core/image.hpp"
#include "corda/core/output_file.hpp"
#include "corda/core/text.hpp"
#include "corda/media/libav_handles.hpp"

namespace corda::media {
namespace {

std::vector<std::string_view> names_of(const Ending& ending) {
    std::vector<std::string_view> names;
    for (const char* const name : ending.codecs)
        if (name != nullptr) names.emplace_back(name);
    return names;
}

/// Adds names that are not there yet.
void add_new(std::string_view name, std::vector<std::string_view>& names) {
    if (std::ranges::find(names, name) == names.end()) names.push_back(name);
}

bool is_available(const Codec& codec) {
    if (codec.version != nullptr) return !codec.version().empty();
    return codec.is_built_in || avcodec_find_encoder_by_name(codec.name) != nullptr;
}

/// Message for a missing codec.
std::string missing_text(const Codec& codec) {
    if (codec.version != nullptr)
        return "this Corda was built without libx264; build it with CORDA_X264, or use --codec libsvtav1";
    return fmt::format(
        "this libavcodec was built without {}; install one that has it (Debian: apt-get install {}), and see "
        "`corda doctor`",
        codec.name, libavcodec_package());
}

const AVPixFmtDescriptor& descriptor_of(const char* pixel_format) {
    return *av_pix_fmt_desc_get(av_get_pix_fmt(pixel_format));
}

bool has_alpha_plane(const char* pixel_format) {
    return (descriptor_of(pixel_format).flags & AV_PIX_FMT_FLAG_ALPHA) != 0;
}

bool is_of_choice(const char* pixel_format, PixelChoice pix) {
    const AVPixFmtDescriptor& descriptor = descriptor_of(pixel_format);
    const bool is_rgb = (descriptor.flags & AV_PIX_FMT_FLAG_RGB) != 0;
    if (pix == PixelChoice::kAuto) return true;
    if (is_rgb || pix == PixelChoice::kRgba) return is_rgb && pix == PixelChoice::kRgba;
    return descriptor.log2_chroma_w == (pix == PixelChoice::k420 ? 1 : 0);
}

const char* word_of(PixelChoice pix) {
    constexpr std::array kWords{"auto", "420", "444", "rgba"};
    return kWords.at(static_cast<std::size_t>(pix));
}

bool has_choice(const Codec& codec, PixelChoice pix) {
    return std::ranges::any_of(
        codec.pixel_formats, [pix](const char* name) { return name != nullptr && is_of_choice(name, pix); });
}

/// The choices of video.pix that a codec has.
std::vector<const char*> pixel_words(const Codec& codec) {
    std::vector<const char*> words;
    for (const PixelChoice pix : {PixelChoice::k420, PixelChoice::k444, PixelChoice::kRgba}) {
        if (has_choice(codec, pix)) words.push_back(word_of(pix));
    }
    return words;
}

/// The codec that is asked for, or the first of the ending that libavcodec has.
const Codec& choose_codec(const Ending& ending, std::string_view path, const EncoderDef& def,
                          bool& is_fallback) {
    const auto names = names_of(ending);
    if (def.codec.empty() || ending.kind == FileKind::kAnimation) {
        for (const std::string_view name : names) {
            const Codec& codec = *find_codec(name);
            if (is_available(codec) && !codec.is_hardware) return codec;
            is_fallback = true;
        }
        throw_error(ExitCode::kEncoder,
                    "'{}': none of the encoders {} is here; install a libavcodec that has them (Debian: "
                    "apt-get install {}), and see `corda doctor`",
                    path, fmt::join(names, ", "), libavcodec_package());
    }
    const Codec* chosen = nullptr;
    for (const std::string_view name : names) {
        const Codec& codec = *find_codec(name);
        if (def.codec != codec.name && def.codec != codec.short_name) continue;
        const bool is_better = chosen == nullptr || !is_available(*chosen) || !has_choice(*chosen, def.pix);
        if (is_better && (chosen == nullptr || is_available(codec))) chosen = &codec;
    }
    if (chosen != nullptr && is_available(*chosen)) return *chosen;
    if (chosen != nullptr) throw Error(ExitCode::kEncoder, missing_text(*chosen));
    throw_usage("'{}' cannot hold the codec '{}'; use {}", path, def.codec, fmt::join(names, ", "));
}

/// The first pixel format of the codec that is of the choice and, if that is possible, has alpha as wanted.
const char* choose_pixels(const Format& format, const VideoDef& def, bool is_transparent) {
    const char* chosen = nullptr;
    for (const char* const name : format.codec->pixel_formats) {
        if (name == nullptr || !is_of_choice(name, def.encoder.pix)) continue;
        if (has_alpha_plane(name) == is_transparent) return name;
        if (chosen == nullptr) chosen = name;
    }
    if (chosen != nullptr) return chosen;
    const auto words = pixel_words(*format.codec);
    throw_usage("video.pix {} is not what {} is made of; use {}, another codec, or leave it out",
                word_of(def.encoder.pix), format.words(), fmt::join(words, " or "));
}

/// The even numbers next to an odd side: "1080 or 1082".
std::string even_sides(int side) {
    return side % 2 == 0 ? std::to_string(side)
           : side == 1   ? std::string("2")
                         : fmt::format("{} or {}", side - 1, side + 1);
}

void check_size_for(const Format& format, const VideoDef& def) {
    const Codec& codec = *format.codec;
    const Ending& ending = *format.ending;
    const bool is_odd = def.width_px % 2 != 0 || def.height_px % 2 != 0;
    if (is_odd && descriptor_of(format.pixel_format).log2_chroma_w == 1) {
        throw_usage(
            "video size {}x{} is odd, and {} 4:2:0 needs even sides; use a width of {} and a height of {} "
            "(render --pad takes the larger ones)",
            def.width_px, def.height_px, codec.standard, even_sides(def.width_px), even_sides(def.height_px));
    }
    if (std::min(def.width_px, def.height_px) < codec.min_side_px) {
        throw_usage("video size {}x{} is too small for {}; use sides of {} or more, or another {}",
                    def.width_px, def.height_px, codec.name, codec.min_side_px,
                    names_of(ending).size() > 1 ? "codec" : "format");
    }
    if (def.height_px > codec.max_height_px) {
        throw_usage("video size {}x{} is too tall for {}; use a height of {} or less, or another codec",
                    def.width_px, def.height_px, codec.name, codec.max_height_px);
    }
}

void check_preset(const Format& format, const EncoderDef& def) {
    const Codec& codec = *format.codec;
    const auto& presets = codec.presets;
    if (def.preset.empty() || std::ranges::find(presets, def.preset) != presets.end()) return;
    if (presets.empty())
        throw_usage("preset '{}': {} has no presets; leave it out", def.preset, format.words());
    throw_usage("preset '{}' is unknown to {}; use one of {}", def.preset, codec.name,
                fmt::join(presets, ", "));
}

void check_crf(const Format& format, const EncoderDef& def) {
    const Codec& codec = *format.codec;
    if (!def.crf) return;
    if (!codec.crf) throw_usage("crf {}: {} has no rate factor; leave it out", *def.crf, format.words());
    if (*def.crf >= codec.crf->first && *def.crf <= codec.crf->second) return;
    throw_usage("crf {} is out of range; use {} to {} for {}{}", *def.crf, codec.crf->first,
                codec.crf->second, codec.name,
                std::string_view(codec.name) == "libx264" && *def.crf == 0
                    ? " (0 is lossless 4:4:4, which browsers refuse; .mkv is lossless)"
                    : "");
}

/// The pauses of a GIF are whole hundredths of a second, and pauses shorter than two play slowly.
void check_gif_rate(Rational fps) {
    constexpr std::int64_t kLongestPause = 65535;
    const bool is_fast = fps.num > 50 * fps.den;
    if (!is_fast && 100 * fps.den <= kLongestPause * fps.num) return;
    const std::string possible = is_fast ? "50" : Rational::reduced(100, kLongestPause).text();
    throw_usage(
        "a GIF cannot have {} frames per second: its pauses are 2 to {} hundredths of a second; use {} "
        "(--fps {}), or another format",
        fps.text(), kLongestPause, possible, possible);
}

void check_rate_for(const Format& format, const VideoDef& def) {
    const Rational fps = def.fps.rational();
    const std::string_view muxer = format.ending->muxer;
    if (muxer == "gif") check_gif_rate(fps);
    constexpr double kMaxMsRate = 1000.0;
    const bool counts_ms = muxer == "matroska" || muxer == "webm";
    if (counts_ms && fps.value() > kMaxMsRate)
        throw_usage("{} cannot have {} frames per second: it counts milliseconds; use {} or less, or .mp4",
                    format.ending->words, fps.text(), kMaxMsRate);
}

}  // namespace

std::string Format::words() const {
    if (ending->kind == FileKind::kAnimation) return ending->words;
    return fmt::format("{} in {}", codec->standard, ending->words);
}

std::string Format::library_versions() const {
    const auto text = [](const char* name, unsigned version) {
        return fmt::format("{} {}.{}.{}", name, AV_VERSION_MAJOR(version), AV_VERSION_MINOR(version),
                           AV_VERSION_MICRO(version));
    };
    const std::string encoder =
        codec->version != nullptr ? codec->version() : text("libavcodec", avcodec_version());
    return encoder + ", " + text("libavformat", avformat_version());
}

std::int64_t passes(const Ending& ending) {
    return ending.kind == FileKind::kAnimation ? 2 : 1;
}

std::string Format::preset_of(const EncoderDef& def) const {
    return def.preset.empty() ? codec->default_preset : def.preset;
}

int Format::crf_of(const EncoderDef& def) const {
    const bool is_other = has_alpha && codec->default_crf_of_alpha > 0;
    return def.crf.value_or(is_other ? codec->default_crf_of_alpha : codec->default_crf);
}

std::vector<std::string_view> codec_names() {
    std::vector<std::string_view> names;
    const auto can_be_asked_for = [](const Codec& codec) {
        return std::ranges::any_of(endings(), [&codec](const Ending& ending) {
            const auto of_ending = names_of(ending);
            return ending.kind != FileKind::kAnimation &&
                   std::ranges::find(of_ending, codec.name) != of_ending.end();
        });
    };
    for (const Codec& codec : codecs())
        if (can_be_asked_for(codec)) add_new(codec.name, names);
    for (const Codec& codec : codecs())
        if (can_be_asked_for(codec)) add_new(codec.short_name, names);
    return names;
}

std::vector<std::string_view> preset_names() {
    std::vector<std::string_view> names;
    for (const Codec& codec : codecs())
        for (const char* const preset : codec.presets) add_new(preset, names);
    return names;
}

const Codec* find_codec(std::string_view name) {
    const auto row = std::ranges::find_if(
        codecs(), [name](const Codec& codec) { return name == codec.name || name == codec.short_name; });
    return row == codecs().end() ? nullptr : &*row;
}

const Ending& find_ending(std::string_view path) {
    const auto row_of = [](FileKind kind) -> const Ending& {
        return *std::ranges::find(endings(), kind, &Ending::kind);
    };
    if (is_standard_output(std::string(path))) return row_of(FileKind::kStream);
    const std::string ending = std::filesystem::path(path).extension().string();
    if (ending == ".png") {
        check_picture_names(path);
        return row_of(FileKind::kPictures);
    }
    const auto find = [](std::string_view text) {
        return text.empty()
                   ? endings().end()
                   : std::ranges::find_if(endings(), [text](const Ending& row) { return text == row.text; });
    };
    if (const auto row = find(ending); row != endings().end()) return *row;
    const std::string usual = lower(ending);
    if (usual == ".png" || find(usual) != endings().end())
        throw_usage("'{}': the ending of the name tells the format; write it in lower case: {}", path, usual);
    std::vector<std::string_view> known;
    for (const Ending& candidate : endings()) known.emplace_back(candidate.text);
    throw_usage("'{}': the ending of the name tells the format, and this one is not known; use {}", path,
                fmt::join(known, ", "));
}

Format find_format(std::string_view path, const VideoDef& def, bool is_transparent) {
    Format format;
    format.ending = &find_ending(path);
    format.codec = &choose_codec(*format.ending, path, def.encoder, format.is_fallback);
    format.pixel_format = choose_pixels(format, def, is_transparent);
    format.has_alpha = has_alpha_plane(format.pixel_format);
    if (format.ending->kind == FileKind::kAnimation && !def.encoder.codec.empty())
        throw_usage("'{}' cannot hold the codec '{}'; leave it out", path, def.encoder.codec);
    if (def.loop != 0 && format.ending->kind != FileKind::kAnimation)
        throw_usage("video.loop = {}: {} does not say how often it plays; leave it out, or write a .gif",
                    def.loop, format.words());
    check_size_for(format, def);
    check_preset(format, def.encoder);
    check_crf(format, def.encoder);
    check_rate_for(format, def);
    return format;
}

void check_video_def(const VideoDef& def) {
    if (!is_picture_size(def.width_px, def.height_px)) {
        throw_usage(
            "video size {}x{} is out of range: each side is 1 to {}, and a frame has at most {} pixels",
            def.width_px, def.height_px, kMaxSidePx, kMaxPicturePx);
    }
    if (!def.fps.rational().is_rate()) {
        throw_usage("frame rate {} is out of range; use a positive rate such as 60 or 30000/1001",
                    def.fps.rational().text());
    }
    if (def.encoder.threads < 1 || def.encoder.threads > EncoderDef::kMaxThreads) {
        throw_usage("{} encoder threads are out of range; use 1 to {}", def.encoder.threads,
                    EncoderDef::kMaxThreads);
    }
    if (def.encoder.jobs < 0 || def.encoder.jobs > EncoderDef::kMaxThreads) {
        throw_usage("{} encoder jobs are out of range; use 0 (one per core) to {}", def.encoder.jobs,
                    EncoderDef::kMaxThreads);
    }
    if (!def.encoder.codec.empty() && find_codec(def.encoder.codec) == nullptr)
        throw_usage("unknown codec '{}'; use {}", def.encoder.codec, fmt::join(codec_names(), ", "));
}

std::string libavcodec_package() {
    return fmt::format("libavcodec{}", LIBAVCODEC_VERSION_MAJOR);
}

std::string endings_with_alpha() {
    std::vector<std::string_view> names;
    for (const Ending& ending : endings()) {
        if (can_be_transparent(ending) && ending.kind != FileKind::kStream) names.emplace_back(ending.text);
    }
    return fmt::format("{}", fmt::join(names, ", "));
}

bool can_be_transparent(const Ending& ending) {
    const auto& formats = find_codec(ending.codecs.front())->pixel_formats;
    return std::ranges::any_of(formats,
                               [](const char* name) { return name != nullptr && has_alpha_plane(name); });
}

}  // namespace corda::media
