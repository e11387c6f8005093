#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#pragma GCC visibility push(default)
namespace corda {

/// A fraction of two integers in lowest terms, `den > 0`.
struct Rational {
    /// The largest part of one that is read from a text or given as a rate.
    static constexpr std::int64_t kMaxPart = 1'000'000'000;

    std::int64_t num = 0;
    std::int64_t den = 1;

    /// Reads "60" or "30000/1001". Returns std::nullopt for any other text, a zero denominator, or a part
    /// over kMaxPart.
    static std::optional<Rational> parse(std::string_view text);

    /// The fraction in lowest terms. Requires `den != 0`.
    static Rational reduced(std::int64_t num, std::int64_t den);

    /// "60" or "30000/1001".
    [[nodiscard]] std::string text() const;

    /// Whether it can be a frame rate: both parts are within 1 .. kMaxPart.
    [[nodiscard]] bool is_rate() const { return num >= 1 && num <= kMaxPart && den >= 1 && den <= kMaxPart; }

    [[nodiscard]] double value() const { return static_cast<double>(num) / static_cast<double>(den); }

    friend bool operator==(const Rational&, const Rational&) = default;
};

/// A constant number of frames per second, and the exact times of those frames.
///
/// Frame k is at exactly k * den / num seconds, computed from integers and never accumulated.
class FrameRate {
  public:
    FrameRate() = default;
    /// Requires Rational::is_rate().
    explicit FrameRate(Rational frames_per_second) : rate_(frames_per_second) {}

    [[nodiscard]] Rational rational() const { return rate_; }
    [[nodiscard]] double per_second() const { return rate_.value(); }

    /// Seconds between two frames, rounded once.
    [[nodiscard]] double interval_s() const {
        return static_cast<double>(rate_.den) / static_cast<double>(rate_.num);
    }

    /// The time of frame `k` in seconds, rounded once.
    [[nodiscard]] double time_s(std::int64_t k) const {
        return static_cast<double>(k * rate_.den) / static_cast<double>(rate_.num);
    }

    /// Number of images of a video of `duration_s`: the frames that start before its end. A duration within
    /// 1e-9 of a frame's time counts as that time, so 0.1 s at 30 per second are 3 frames although 0.1 * 30 >
    /// 3 in binary.
    [[nodiscard]] std::int64_t frame_count(double duration_s) const;

    /// Index of the last frame time that is not after `duration_s` (same 1e-9 rule).
    [[nodiscard]] std::int64_t last_frame_within(double duration_s) const;

    friend bool operator==(const FrameRate&, const FrameRate&) = default;

  private:
    Rational rate_{60, 1};
};

}  // namespace corda
#pragma GCC visibility pop
