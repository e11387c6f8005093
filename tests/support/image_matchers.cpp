#include "support/image_matchers.hpp"

#include <algorithm>
#include <cstring>

namespace corda::test {

testing::AssertionResult equal_images(const Image& actual, const Image& expected) {
    if (actual == expected) return testing::AssertionSuccess();
    auto failure = testing::AssertionFailure();
    if (actual.width() != expected.width() || actual.height() != expected.height()) {
        return failure << "sizes " << actual.width() << "x" << actual.height() << " and " << expected.width()
                       << "x" << expected.height();
    }
    int differing = 0;
    for (int y = 0; y < actual.height(); ++y) {
        for (int x = 0; x < actual.width(); ++x) {
            const std::uint8_t* a = actual.pixel(x, y);
            const std::uint8_t* e = expected.pixel(x, y);
            if (std::memcmp(a, e, 4) == 0) continue;
            if (differing++ == 0) {
                failure << "first at (" << x << ", " << y << "): " << +a[0] << ' ' << +a[1] << ' ' << +a[2]
                        << ' ' << +a[3] << " in place of " << +e[0] << ' ' << +e[1] << ' ' << +e[2] << ' '
                        << +e[3];
            }
        }
    }
    return failure << "; " << differing << " pixels differ";
}

}  // namespace corda::test
