#include "corda/render/stamps.hpp"

#include <array>
#include <cstdint>

#include "corda/render/coverage.hpp"

namespace corda::render {

void paint_stamps(const view::DrawList& list, const PixelRect& part, Image& image) {
    for (const view::Stamp& stamp : list.stamps) {
        const PixelRect box = stamp.box.intersected(part);
        const std::array<std::uint8_t, 4> own{stamp.color.r, stamp.color.g, stamp.color.b, 255};
        for (int y = box.y0; y < box.y1; ++y) {
            for (int x = box.x0; x < box.x1; ++x) {
                std::uint32_t coverage = 255;
                if (stamp.first_coverage != view::Stamp::kSolid) {
                    const std::size_t row = static_cast<std::size_t>(y - stamp.box.y0) * stamp.box.width();
                    coverage = list.coverage[stamp.first_coverage + row + (x - stamp.box.x0)];
                }
                std::uint8_t* pixel = image.pixel(x, y);
                for (int c = 0; c < 4 && coverage > 0; ++c)
                    pixel[c] =
                        static_cast<std::uint8_t>(paint_over(pixel[c], own[c], stamp.color.a, coverage));
            }
        }
    }
}

void straighten(const PixelRect& part, Image& image) {
    for (int y = part.y0; y < part.y1; ++y) {
        for (int x = part.x0; x < part.x1; ++x) straighten(image.pixel(x, y));
    }
}

}  // namespace corda::render
