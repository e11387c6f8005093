#include "corda/render/frame_renderer.hpp"

#include <vector>

#include "corda/render/coverage.hpp"
#include "corda/render/exposure.hpp"
#include "corda/render/paint.hpp"
#include "corda/render/tiles.hpp"
#include "corda/view/draw_list.hpp"

namespace corda::render {
namespace {

/// Coverage of every pixel by a layer, 0 .. 255.
struct Mask {
    std::vector<std::uint8_t> line;
    std::vector<std::uint8_t> halo;
    std::vector<TintSums> tints;  ///< empty if no layer is tinted
};

void unite(const view::Capsule& capsule, bool is_tinted, const PixelRect& box, int width, Mask& mask) {
    for (int y = box.y0; y < box.y1; ++y) {
        for (int x = box.x0; x < box.x1; ++x) {
            const float center_x = static_cast<float>(x) + 0.5F;
            const float center_y = static_cast<float>(y) + 0.5F;
            const float distance_px = segment_distance_px(capsule, center_x, center_y);
            const std::size_t i = static_cast<std::size_t>(y) * width + x;
            const auto add = [](std::uint8_t& united, std::uint32_t coverage) {
                united = std::max(united, static_cast<std::uint8_t>(coverage));
            };
            const std::uint32_t coverage = coverage_within(capsule.radius, distance_px, capsule.strength);
            add(mask.line[i], coverage);
            add(mask.halo[i], coverage_within(capsule.halo_radius, distance_px));
            if (!is_tinted) continue;
            mask.tints[i].add(capsule.tint, tint_weight(capsule, center_x, center_y, coverage));
        }
    }
}

/// Paints a layer and clears its mask.
void paint(Color color, bool is_tinted, const PixelRect& box, const Image& ground, Mask& mask, Image& image) {
    for (int y = box.y0; y < box.y1; ++y) {
        for (int x = box.x0; x < box.x1; ++x) {
            const std::size_t i = static_cast<std::size_t>(y) * image.width() + x;
            std::uint8_t* pixel = image.pixel(x, y);
            const std::uint8_t* bare = ground.pixel(x, y);
            if (is_tinted) {
                const TintSums& sums = mask.tints[i];
                color.r = static_cast<std::uint8_t>(sums.mean(sums.r));
                color.g = static_cast<std::uint8_t>(sums.mean(sums.g));
                color.b = static_cast<std::uint8_t>(sums.mean(sums.b));
                mask.tints[i] = {};
            }
            const auto channel = [&](int c, std::uint8_t own) {
                const std::uint32_t below = paint_over(pixel[c], bare[c], color.a, mask.halo[i]);
                pixel[c] = static_cast<std::uint8_t>(paint_over(below, own, color.a, mask.line[i]));
            };
            channel(0, color.r);
            channel(1, color.g);
            channel(2, color.b);
            channel(3, 255);
            mask.line[i] = 0;
            mask.halo[i] = 0;
        }
    }
}

/// The layers on the ground, premultiplied.
Image render_layers(const view::DrawList& list) {
    Image ground(list.width, list.height);
    GroundRows(list.ground, list.height).write(ground.rect(), ground);
    Image image = ground;
    const std::size_t pixels = static_cast<std::size_t>(list.width) * list.height;
    Mask mask{std::vector<std::uint8_t>(pixels), std::vector<std::uint8_t>(pixels), {}};
    for (const view::Layer& layer : list.layers) {
        PixelRect touched;
        if (layer.is_tinted) mask.tints.resize(pixels);
        for (std::size_t i = 0; i < layer.capsule_count; ++i) {
            const view::Capsule& capsule = list.capsules[layer.first_capsule + i];
            const PixelRect box = view::capsule_bounds(capsule, list.width, list.height);
            unite(capsule, layer.is_tinted, box, list.width, mask);
            touched = touched.united(box);
        }
        paint(layer.color, layer.is_tinted, touched, ground, mask, image);
    }
    return image;
}

void finish(const view::DrawList& list, Image& image) {
    paint_stamps(list, image.rect(), image);
    straighten(image.rect(), image);
}

}  // namespace

Image render_reference(const view::DrawList& list) {
    Image image = render_layers(list);
    finish(list, image);
    return image;
}

Image render_reference(std::span<const view::DrawList> exposed, const view::DrawList& list) {
    Image image(list.width, list.height);
    Exposure exposure(list.width, list.height);
    const std::vector<std::uint8_t> everywhere(tile_count(list.width, list.height), 1);
    for (const view::DrawList& one : exposed) exposure.add(render_layers(one), everywhere, list.ground);
    exposure.develop(list.ground, image);
    finish(list, image);
    return image;
}

void mark_covered(const view::DrawList& list, std::uint8_t id, std::span<std::uint8_t> mask) {
    constexpr std::uint32_t kHalf = 128;
    for (const view::Capsule& capsule : list.capsules) {
        const PixelRect box = view::capsule_bounds(capsule, list.width, list.height);
        for (int y = box.y0; y < box.y1; ++y) {
            for (int x = box.x0; x < box.x1; ++x) {
                const float distance_px =
                    segment_distance_px(capsule, static_cast<float>(x) + 0.5F, static_cast<float>(y) + 0.5F);
                if (coverage_within(capsule.radius, distance_px) >= kHalf)
                    mask[static_cast<std::size_t>(y) * list.width + x] = id;
            }
        }
    }
}

}  // namespace corda::render
