#include "corda/render/reference_renderer.hpp"

#include <vector>

#include "corda/render/coverage.hpp"
#include "corda/view/capsule.hpp"

namespace corda::render {
namespace {

void fill(const Color& color, Image& image) {
    for (int y = 0; y < image.height(); ++y) {
        for (int x = 0; x < image.width(); ++x) {
            std::uint8_t* pixel = image.pixel(x, y);
            pixel[0] = color.r;
            pixel[1] = color.g;
            pixel[2] = color.b;
            pixel[3] = 255;
        }
    }
}

void unite(const view::Capsule& capsule, int width, int height, std::vector<std::uint8_t>& mask) {
    const PixelRect box = view::capsule_bounds(capsule, width, height);
    for (int y = box.y0; y < box.y1; ++y) {
        for (int x = box.x0; x < box.x1; ++x) {
            const std::uint32_t coverage =
                capsule_coverage(capsule, static_cast<float>(x) + 0.5F, static_cast<float>(y) + 0.5F);
            std::uint8_t& united = mask[static_cast<std::size_t>(y) * width + x];
            united = std::max(united, static_cast<std::uint8_t>(coverage));
        }
    }
}

void paint(const Color& color, const std::vector<std::uint8_t>& mask, const PixelRect& box, Image& image) {
    for (int y = box.y0; y < box.y1; ++y) {
        for (int x = box.x0; x < box.x1; ++x) {
            const std::uint32_t coverage = mask[static_cast<std::size_t>(y) * image.width() + x];
            std::uint8_t* pixel = image.pixel(x, y);
            pixel[0] = static_cast<std::uint8_t>(paint_over(pixel[0], color.r, color.a, coverage));
            pixel[1] = static_cast<std::uint8_t>(paint_over(pixel[1], color.g, color.a, coverage));
            pixel[2] = static_cast<std::uint8_t>(paint_over(pixel[2], color.b, color.a, coverage));
        }
    }
}

}  // namespace

Image render_reference(const view::DrawList& list) {
    Image image(list.width, list.height);
    fill(list.background, image);
    std::vector<std::uint8_t> mask(static_cast<std::size_t>(list.width) * list.height);
    for (const view::Layer& layer : list.layers) {
        std::fill(mask.begin(), mask.end(), std::uint8_t{0});
        for (std::size_t i = 0; i < layer.capsule_count; ++i) {
            unite(list.capsules[layer.first_capsule + i], list.width, list.height, mask);
        }
        paint(layer.color, mask, image.rect(), image);
    }
    return image;
}

}  // namespace corda::render
