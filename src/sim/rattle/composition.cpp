#include "corda/sim/rattle/composition.hpp"

#include <array>
#include <cassert>

namespace corda::sim {
namespace {

constexpr std::array<double, 1> kOrder2{1.0};

// Suzuki (1990): four times 1 / (4 - 4^(1/3)), and in the middle what makes the sum 1.
constexpr double kSuzuki = 0.41449077179437573714235406286;
constexpr std::array<double, 5> kOrder4{kSuzuki, kSuzuki, -0.65796308717750294856941625145, kSuzuki, kSuzuki};

// Kahan and Li (1997), s9odr6a.
constexpr double kSix1 = 0.39216144400731413927925056;
constexpr double kSix2 = 0.33259913678935943859974864;
constexpr double kSix3 = -0.70624617255763935980996482;
constexpr double kSix4 = 0.08221359629355080023149045;
constexpr double kSix5 = 0.79854399093482996339895035;
constexpr std::array<double, 9> kOrder6{kSix1, kSix2, kSix3, kSix4, kSix5, kSix4, kSix3, kSix2, kSix1};

// Kahan and Li (1997), s17odr8a.
constexpr double kEight1 = 0.13020248308889008087881763;
constexpr double kEight2 = 0.56116298177510838456196441;
constexpr double kEight3 = -0.38947496264484728640807860;
constexpr double kEight4 = 0.15884190655515560089621075;
constexpr double kEight5 = -0.39590389413323757733623154;
constexpr double kEight6 = 0.18453964097831570709183254;
constexpr double kEight7 = 0.25837438768632204729397911;
constexpr double kEight8 = 0.29501172360931029887096624;
constexpr double kEight9 = -0.60550853383003451169892108;
constexpr std::array<double, 17> kOrder8{kEight1, kEight2, kEight3, kEight4, kEight5, kEight6,
                                         kEight7, kEight8, kEight9, kEight8, kEight7, kEight6,
                                         kEight5, kEight4, kEight3, kEight2, kEight1};

constexpr std::array<Composition, 4> kCompositions{
    Composition{2, kOrder2, 2.0},
    Composition{4, kOrder4, 2.72},
    Composition{6, kOrder6, 2.53},
    Composition{8, kOrder8, 3.09},
};

}  // namespace

const Composition& composition(int order) {
    assert(order == 2 || order == 4 || order == 6 || order == 8);
    return kCompositions[static_cast<std::size_t>(order / 2 - 1)];
}

}  // namespace corda::sim
