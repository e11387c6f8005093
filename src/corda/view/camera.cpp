#include "corda/view/camera.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>
#include <vector>

#include "corda/core/exponential.hpp"

namespace corda::view {
namespace {

/// The extent that is shown of a scene in which all particles stay in one place, in metres.
constexpr double kMinViewMetres = 1e-6;

/// A scale at which pixels do not count.
constexpr double kFinest = 1e100;

/// Extent of a drawn item along one axis: around `low_m` it extends `before_px` towards smaller coordinates,
/// around `high_m` `after_px` towards larger ones.
struct Span {
    double low_m;
    double high_m;
    double before_px;
    double after_px;
};

/// All extents along one axis.
class Axis {
  public:
    explicit Axis(std::vector<Span> spans) : spans_(std::move(spans)) {}

    /// The middle of the extents at that scale.
    [[nodiscard]] double middle_m(double pixels_per_metre) const {
        const Ends ends = ends_at(pixels_per_metre);
        const double low_px = pixels_per_metre * ends.low->low_m - ends.low->before_px;
        const double high_px = pixels_per_metre * ends.high->high_m + ends.high->after_px;
        return 0.5 * (low_px + high_px) / pixels_per_metre;
    }

    /// The largest scale at which all fits into `room_px`. Thick lines may leave no room in a tiny picture;
    /// the motion always gets at least a tenth.
    [[nodiscard]] double scale(double room_px) const {
        // The extent grows with the scale by the convex function high - low: Newton's method comes down to
        // the root in a finite number of steps.
        double scale = room_px / extent_m(ends_at(kFinest));
        const double least = 0.1 * scale;
        for (std::size_t i = 0; i <= 2 * spans_.size(); ++i) {
            const Ends ends = ends_at(scale);
            const double fits = (room_px - ends.low->before_px - ends.high->after_px) / extent_m(ends);
            if (!(fits < scale)) break;
            scale = fits;
            if (scale < least) return least;
        }
        return scale;
    }

    /// The same with `center_m` in the middle of the room.
    [[nodiscard]] double scale(double room_px, double center_m) const {
        double scale = 1e300;
        double least = 1e300;
        for (const Span& span : spans_) {
            const auto limit = [&](double away_m, double extent_px) {
                const double half_m = std::max(away_m, 0.5 * kMinViewMetres);
                scale = std::min(scale, (0.5 * room_px - extent_px) / half_m);
                least = std::min(least, 0.1 * 0.5 * room_px / half_m);
            };
            limit(center_m - span.low_m, span.before_px);
            limit(span.high_m - center_m, span.after_px);
        }
        return std::max(scale, least);
    }

  private:
    /// The items that reach farthest in both directions.
    struct Ends {
        const Span* low;
        const Span* high;
    };

    [[nodiscard]] Ends ends_at(double scale) const {
        Ends ends{&spans_.front(), &spans_.front()};
        for (const Span& span : spans_) {
            if (scale * span.low_m - span.before_px < scale * ends.low->low_m - ends.low->before_px)
                ends.low = &span;
            if (scale * span.high_m + span.after_px > scale * ends.high->high_m + ends.high->after_px)
                ends.high = &span;
        }
        return ends;
    }

    [[nodiscard]] static double extent_m(const Ends& ends) {
        return std::max(ends.high->high_m - ends.low->low_m, kMinViewMetres);
    }

    std::vector<Span> spans_;
};

/// ln(b / a) of the heights of two keys.
double log_ratio(const CameraTrack::Key& a, const CameraTrack::Key& b) {
    return natural_log(b.height_m / a.height_m);
}

}  // namespace

double least_height_m(const CameraDef& def, double height_m) {
    double least_m = def.path.empty() ? height_m : HUGE_VAL;
    for (const CameraKeyDef& key : def.path) least_m = std::min(least_m, key.height_m.value_or(height_m));
    return least_m;
}

double errors_shown(const CameraDef& def) {
    return def.follow ? 2.0 : 1.0;
}

double error_px(const CameraDef& def, double error_m, double height_m, int height_px) {
    return errors_shown(def) * error_m * height_px / least_height_m(def, height_m);
}

CameraDef fit_camera(const CameraDef& def, Vec2 origin_m, std::span<const Drawn> drawn, int width_px,
                     int height_px, const Insets& insets) {
    if (def.center_m && def.height_m) return def;
    assert(!drawn.empty());
    std::vector<Span> across;
    std::vector<Span> upwards;
    for (const Drawn& d : drawn) {
        across.push_back({d.bounds.min_m().x, d.bounds.max_m().x, d.left_px, d.right_px});
        upwards.push_back({d.bounds.min_m().y, d.bounds.max_m().y, d.down_px, d.up_px});
    }
    const Axis x(std::move(across));
    const Axis y(std::move(upwards));
    CameraDef fitted = def;
    const double border_px = def.margin * std::min(width_px, height_px);
    const double top_px = std::max(border_px, insets.top_px);
    const double bottom_px = std::max(border_px, insets.bottom_px) + insets.bottom_panel_px;
    const double right_px = border_px + insets.right_panel_px;
    if (!def.height_m) {
        // About a centre that is given, the larger inset counts twice, as far as it leaves room.
        const auto room_px = [&](double all_px, double one_px, double other_px) {
            const double left_px = all_px - one_px - other_px;
            return def.center_m ? std::max(all_px - 2.0 * std::max(one_px, other_px), 0.5 * left_px)
                                : left_px;
        };
        const double room_x_px = room_px(width_px, border_px, right_px);
        const double room_y_px = room_px(height_px, top_px, bottom_px);
        const Vec2 center = def.center_m.value_or(Vec2{}) - origin_m;
        const double scale = def.center_m
                                 ? std::min(x.scale(room_x_px, center.x), y.scale(room_y_px, center.y))
                                 : std::min(x.scale(room_x_px), y.scale(room_y_px));
        fitted.height_m = height_px / scale;
    }
    const double scale = height_px / *fitted.height_m;
    const Vec2 shift_m{0.5 * (right_px - border_px) / scale, 0.5 * (top_px - bottom_px) / scale};
    if (!def.center_m) fitted.center_m = origin_m + Vec2{x.middle_m(scale), y.middle_m(scale)} + shift_m;
    return fitted;
}

CameraTrack::CameraTrack(std::vector<Key> keys) : keys_(std::move(keys)), slopes_(keys_.size()) {
    for (std::size_t i = 1; i + 1 < keys_.size(); ++i) {
        const Key& a = keys_[i - 1];
        const Key& b = keys_[i];
        const Key& c = keys_[i + 1];
        const double before_s = b.time_s - a.time_s;
        const double after_s = c.time_s - b.time_s;
        const auto slope = [&](double from, double at, double to) {
            const double before = (at - from) / before_s;
            const double after = (to - at) / after_s;
            if (before * after <= 0.0) return 0.0;
            const double w = 2.0 * after_s + before_s;
            const double v = after_s + 2.0 * before_s;
            return (w + v) / (w / before + v / after);
        };
        slopes_[i].center_m = {slope(a.center_m.x, b.center_m.x, c.center_m.x),
                               slope(a.center_m.y, b.center_m.y, c.center_m.y)};
        slopes_[i].height_m = slope(-log_ratio(a, b), 0.0, log_ratio(b, c));
    }
}

CameraDef CameraTrack::at(const CameraDef& def, double time_s) const {
    const auto later = std::ranges::upper_bound(keys_, time_s, {}, &Key::time_s);
    const auto i = static_cast<std::size_t>(later - keys_.begin());
    CameraDef placed = def;
    if (i == 0 || i == keys_.size()) {
        const Key& key = i == 0 ? keys_.front() : keys_.back();
        placed.center_m = key.center_m;
        placed.height_m = key.height_m;
        return placed;
    }
    const Key& a = keys_[i - 1];
    const Key& b = keys_[i];
    const double step_s = b.time_s - a.time_s;
    const double t = (time_s - a.time_s) / step_s;
    const auto between = [&](double from, double to, double from_slope, double to_slope) {
        const double u = 1.0 - t;
        return from + t * t * (3.0 - 2.0 * t) * (to - from) +
               step_s * t * u * (u * from_slope - t * to_slope);
    };
    const Key& va = slopes_[i - 1];
    const Key& vb = slopes_[i];
    placed.center_m = {between(a.center_m.x, b.center_m.x, va.center_m.x, vb.center_m.x),
                       between(a.center_m.y, b.center_m.y, va.center_m.y, vb.center_m.y)};
    // exp(0) is 1: a height that stays is exact.
    placed.height_m = a.height_m * exponential(between(0.0, log_ratio(a, b), va.height_m, vb.height_m));
    return placed;
}

Camera::Camera(const CameraDef& def, Vec2 origin_m, int width_px, int height_px)
    : center_(def.center_m.value() - origin_m),
      pixels_per_metre_(height_px / def.height_m.value()),
      half_width_px_(0.5 * width_px),
      half_height_px_(0.5 * height_px) {}

}  // namespace corda::view
