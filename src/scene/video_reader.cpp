#include <fmt/format.h>

#include <array>
#include <cmath>
#include <optional>

#include "corda/scene/readers.hpp"

namespace corda::scene {
namespace {

constexpr double kSlowestFps = 1e-3;
constexpr double kFastestFps = 100'000.0;
constexpr std::string_view kFpsRemedy = R"(give an integer, or a fraction in quotes such as "30000/1001")";

void read_size(const TableReader& video, media::VideoDef& def) {
    constexpr std::string_view kRemedy = "give a size as [width, height] in pixels";
    const auto size = video.find("size");
    if (!size) return;
    if (size->size(kRemedy) != 2)
        size->fail(fmt::format("this is a list of {}, not a pair; {}", size->size(kRemedy), kRemedy));
    const std::int64_t width = size->at(0).integer(1, Limits::kSidePixels, kRemedy);
    const std::int64_t height = size->at(1).integer(1, Limits::kSidePixels, kRemedy);
    if (width * height > Limits::kFramePixels) {
        size->fail(fmt::format("{} x {} are {} pixels, over the limit of {}; give a smaller size", width,
                               height, width * height, Limits::kFramePixels));
    }
    def.width_px = static_cast<int>(width);
    def.height_px = static_cast<int>(height);
}

/// The fraction that someone who wrote a number such as 29.97 or 12.5 means.
std::optional<Rational> nearest_fraction(double fps) {
    constexpr double kBroadcast = 2e-4;  // 23.98 for 24000/1001 is the coarsest habit
    constexpr std::array<std::int64_t, 5> kBroadcastRates{24, 30, 48, 60, 120};
    for (const std::int64_t rate : kBroadcastRates) {
        const Rational fraction{rate * 1000, 1001};
        if (std::abs(fps / fraction.value() - 1.0) < kBroadcast) return fraction;
    }
    constexpr std::int64_t kLargestDenominator = 1000;
    for (std::int64_t den = 2; den <= kLargestDenominator; ++den) {
        const double num = std::round(fps * static_cast<double>(den));
        if (std::abs(fps * static_cast<double>(den) - num) < 1e-9 * num) {
            return Rational::reduced(static_cast<std::int64_t>(num), den);
        }
    }
    return std::nullopt;
}

Rational fps_from_number(const Value& fps) {
    const double value = fps.number({.low = kSlowestFps, .high = kFastestFps}, kFpsRemedy);
    if (value == std::floor(value)) return {static_cast<std::int64_t>(value), 1};
    const auto fraction = nearest_fraction(value);
    if (!fraction) fps.fail(fmt::format("{} is not an exact rate; {}", value, kFpsRemedy));
    fps.fail(
        fmt::format("{} is not an exact rate; give a fraction in quotes: \"{}\"", value, fraction->text()));
}

Rational read_fps(const Value& fps) {
    if (!fps.is_text()) return fps_from_number(fps);
    const std::string_view text = fps.text(kFpsRemedy);
    const auto rate = Rational::parse(text);
    if (!rate) fps.fail(fmt::format("\"{}\" is not a fraction; {}", printable(text), kFpsRemedy));
    if (rate->value() < kSlowestFps || rate->value() > kFastestFps) {
        fps.fail(fmt::format("\"{}\" is not in 1/1000 .. 100000; give frames a second", printable(text)));
    }
    return *rate;
}

void read_crf(const TableReader& video, int& crf) {
    constexpr std::string_view kRemedy = "give a crf of 1 (best) .. 51";
    constexpr int kWorst = 51;
    const auto value = video.find("crf");
    if (!value) return;
    const std::int64_t number = value->integer(0, kWorst, kRemedy);
    if (number == 0) {
        value->fail(fmt::format("0 selects the profile High 4:4:4, which browsers refuse; {}", kRemedy));
    }
    crf = static_cast<int>(number);
}

}  // namespace

media::VideoDef read_video(const TableReader& video) {
    constexpr std::array<std::string_view, 1> kCodecs{"libx264"};
    constexpr int kMostThreads = 64;
    media::VideoDef def;
    read_size(video, def);
    if (const auto fps = video.find("fps")) def.fps = FrameRate(read_fps(*fps));
    if (const auto codec = video.find("codec")) def.encoder.codec = kCodecs[codec->choice(kCodecs)];
    if (const auto preset = video.find("preset")) {
        const auto& presets = media::x264_presets();
        const std::vector<std::string_view> names(presets.begin(), presets.end());
        def.encoder.preset = presets[preset->choice(names)];
    }
    read_crf(video, def.encoder.crf);
    video.read_integer("threads", def.encoder.threads, 1, kMostThreads,
                       "give the encoder's threads, 1 .. 64");
    return def;
}

}  // namespace corda::scene
