#include "corda/view/camera.hpp"

#include <algorithm>
#include <cassert>
#include <utility>
#include <vector>

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

}  // namespace

bool needs_motion(const CameraDef& def) {
    return !def.center_m || !def.height_m;
}

CameraDef fit_camera(const CameraDef& def, Vec2 origin_m, std::span<const Drawn> drawn, int width_px,
                     int height_px, const Insets& insets) {
    if (!needs_motion(def)) return def;
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

Camera::Camera(const CameraDef& def, Vec2 origin_m, int width_px, int height_px)
    : center_(def.center_m.value() - origin_m),
      pixels_per_metre_(height_px / def.height_m.value()),
      half_width_px_(0.5 * width_px),
      half_height_px_(0.5 * height_px) {}

}  // namespace corda::view
