#include "support/draw_lists.hpp"

#include <cmath>
#include <random>

#include "corda/view/draw_list.hpp"
#include "corda/view/font.hpp"

namespace corda::test {
namespace {

/// std::mt19937 is the same everywhere; the distributions of <random> are not.
class Numbers {
  public:
    explicit Numbers(std::uint32_t seed) : generator_(seed) {}

    double between(double low, double high) {
        return low + (high - low) * (static_cast<double>(generator_()) / 4294967296.0);
    }
    std::uint8_t byte() { return static_cast<std::uint8_t>(generator_() >> 24U); }

  private:
    std::mt19937 generator_;
};

}  // namespace

view::DrawList random_draw_list(std::uint32_t seed, int width, int height, std::size_t layer_count,
                                std::size_t capsules_per_layer, std::size_t stamps,
                                std::size_t tinted_every) {
    Numbers numbers(seed);
    view::DrawList list;
    list.width = width;
    list.height = height;
    const auto opaque = [&numbers] { return Color{numbers.byte(), numbers.byte(), numbers.byte(), 255}; };
    list.ground.top = opaque();
    list.ground.bottom = opaque();
    for (std::size_t l = 0; l < layer_count; ++l) {
        Color color = opaque();
        if (l % 2 == 1) color.a = numbers.byte();
        list.add_layer(color, tinted_every > 0 && l % tinted_every == 0);
        for (std::size_t i = 0; i < capsules_per_layer; ++i) {
            const view::PixelPoint a{numbers.between(-0.2, 1.2) * width, numbers.between(-0.2, 1.2) * height};
            const double reach = i % 7 == 0 ? 1000.0 : 40.0;
            view::PixelPoint b{a.x + numbers.between(-reach, reach), a.y + numbers.between(-reach, reach)};
            if (i % 5 == 0) b = a;
            const double radius_px = 0.1 * std::pow(600.0, numbers.between(0.0, i % 3 == 0 ? 1.0 : 0.5));
            const double halo_px = i % 4 == 0 ? 0.0 : numbers.between(0.0, 9.0);
            list.add_capsule(a, b, radius_px, halo_px, {}, i % 9 == 0 ? numbers.between(0.0, 1.0) : 1.0);
            if (list.layers.back().is_tinted && list.layers.back().capsule_count > 0) {
                list.capsules.back().tint = {numbers.byte(), numbers.byte(), numbers.byte(),
                                             static_cast<std::uint8_t>(i % 6 == 0 ? 64 : 1)};
            }
        }
    }
    view::Font font;
    for (std::size_t i = 0; i < stamps; ++i) {
        const int x = static_cast<int>(numbers.between(-0.2, 1.0) * width);
        const int y = static_cast<int>(numbers.between(0.0, 1.2) * height);
        Color color = opaque();
        if (i % 2 == 1) color.a = numbers.byte();
        if (i % 3 == 0)
            list.add_box({x, y, x + 1 + numbers.byte() / 4, y + 1 + numbers.byte() / 8}, color);
        else
            font.write({x, y, 5 + numbers.byte() / 5, color, "t = 1.20 s, \u2212\u00b5\u00b2 Schw\u00fcnge"},
                       list);
    }
    return list;
}

PixelRect bounds_of(const view::DrawList& list) {
    PixelRect bounds;
    for (const view::Capsule& capsule : list.capsules)
        bounds = bounds.united(view::capsule_bounds(capsule, list.width, list.height));
    return bounds;
}

}  // namespace corda::test
