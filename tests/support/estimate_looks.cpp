#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "support/estimate_families.hpp"

namespace corda::test {
namespace {

constexpr int kLooks = 12;

/// Half to 60 frames per second, and a few frames or some seconds of motion.
void look_between(Random& random, EstimateCase& made, double most_s) {
    const double rate = pick_log(random, 0.5, 60.0);
    made.scene.video.fps = FrameRate(Rational{std::llround(1e3 * rate), 1000});
    made.scene.world.duration_s = std::min(most_s, pick_real(random, 1.5, 20.0) / rate);
    made.looks = kLooks;
}

/// Half the period in s of a pendulum of 1 m, by the arithmetic-geometric mean.
double half_swing_s(double angle, double gravity_m_s2) {
    double a = 1.0;
    double b = std::cos(0.5 * angle);
    for (int i = 0; i < 10; ++i) {
        const double mean = 0.5 * (a + b);
        b = std::sqrt(a * b);
        a = mean;
    }
    return std::numbers::pi / (a * std::sqrt(gravity_m_s2));
}

/// A pendulum with a frame at each turning point, or at some.
EstimateCase in_step(Random& random) {
    const double angle = pick_real(random, 0.2, 2.9);
    const RopeDef rope = crooked_rope(random, 1, angle, 0.0);
    EstimateCase made = one_rope(random, rope, 1.0);
    look_between(random, made, 40.0);
    made.scene.world.drag_1_s = 0.0;
    const double swing_s = made.scene.video.fps.interval_s() / pick(random, 1, 3);
    const double unit_s = half_swing_s(angle, 1.0);
    made.scene.world.gravity_m_s2 = {0.0, -(unit_s / swing_s) * (unit_s / swing_s)};
    return made;
}

EstimateCase slack_string(Random& random) {
    RopeDef rope = crooked_rope(random, pick(random, 1, 4), any_angle(random), 1.5);
    rope.material.is_string = true;
    for (std::size_t k = 0; k + 1 < rope.points_m.size(); ++k) {
        const Vec2 link = rope.points_m[k + 1] - rope.points_m[k];
        rope.rest_m.push_back(std::hypot(link.x, link.y) * pick_real(random, 1.01, 1.5));
    }
    return one_rope(random, rope, 1.0);
}

EstimateCase closed_rope(Random& random) {
    const int links = pick(random, 4, 8);
    RopeDef rope;
    for (int i = 0; i < links; ++i) {
        const double angle = 2.0 * std::numbers::pi * i / links;
        rope.points_m.push_back(
            {0.7 * std::sin(angle), std::cos(angle) + 0.1 * pick_real(random, -1.0, 1.0)});
    }
    rope.closed = true;
    return one_rope(random, rope, 1.0);
}

/// Bodies of most kinds, looked at between their frames.
EstimateCase between_frames(Random& random) {
    EstimateCase made;
    double most_s = 4.0;
    switch (pick(random, 0, 8)) {
        case 0:
            return in_step(random);
        case 1:
            made = slack_string(random);
            most_s = 2.0;
            break;
        case 2:
            made = closed_rope(random);
            most_s = 1.0;
            break;
        case 3: {
            RopeDef rope = crooked_rope(random, pick(random, 1, 6), any_angle(random), 1.0);
            rope.material.compliance_1_n = pick_log(random, 1e-5, 1e-2);
            made = one_rope(random, rope, 1.0);
            break;
        }
        case 4: {
            RopeDef rope = crooked_rope(random, pick(random, 2, 5), any_angle(random), 0.3);
            rope.bending_n_m2 = pick_log(random, 0.01, 100.0);
            made = one_rope(random, rope, 1.0);
            most_s = 1.5;
            break;
        }
        case 5: {
            const int links = pick(random, 3, 8);
            RopeDef rope = crooked_rope(random, links, any_angle(random), 1.2);
            rope.pinned = {0, static_cast<std::uint32_t>(links)};
            made = one_rope(random, rope, 1.0);
            break;
        }
        case 6:
            made = straight_rope(pick(random, 1, 12), 1.0, std::round(pick_real(random, 5.0, 120.0)));
            add_video(random, made.scene);
            break;
        default:
            made = one_rope(random, crooked_rope(random, pick(random, 1, 12), any_angle(random), 1.0), 1.0);
    }
    look_between(random, made, most_s);
    return made;
}

/// A row between two pins that is arched by a part in 1e9 to one in a hundred, and what hangs from it. The
/// time in which it falls through grows with the root of the arch; the truth takes many steps for each.
EstimateCase arched_row(Random& random) {
    const int inner = pick(random, 1, 3);
    const int rows = pick(random, 1, 3);
    const double arch_m = pick_log(random, 1e-8, 1e-2);
    const double lean = pick(random, 0, 1) == 0 ? 0.0 : any_angle(random);
    const double pitch_m = pick_real(random, 0.1, 0.5);
    const Vec2 along{pitch_m * std::cos(lean), pitch_m * std::sin(lean)};
    const Vec2 down{pitch_m * pick_real(random, -0.5, 0.5), -pitch_m};
    NetDef net;
    const int columns = inner + 2;
    std::vector<double> lift_m;
    for (int c = 0; c < columns; ++c)
        lift_m.push_back(c == 0 || c == inner + 1 ? 0.0 : arch_m * pick_real(random, 0.5, 1.0));
    const Vec2 up = (1.0 / pitch_m) * left_of(along);
    for (int r = 0; r < rows; ++r) {
        for (int c = 0; c < columns; ++c) {
            const auto at = static_cast<std::uint32_t>(net.points_m.size());
            net.points_m.push_back(c * along + r * down + lift_m[static_cast<std::size_t>(c)] * up);
            if (c > 0) net.bars.push_back({at - 1, at});
            if (r > 0) net.bars.push_back({at - static_cast<std::uint32_t>(columns), at});
        }
    }
    net.pinned = {0, static_cast<std::uint32_t>(inner + 1)};
    EstimateCase made;
    made.scene.nets = {net};
    add_video(random, made.scene);
    made.scene.world.duration_s = pick_real(random, 0.3, 3.0) * std::sqrt(arch_m / 9.81);
    made.scene.video.fps = FrameRate(
        Rational{std::llround(std::min(1e5, pick_real(random, 2.0, 9.0) / made.scene.world.duration_s)), 1});
    made.looks = kLooks;
    return made;
}

EstimateCase followed_camera(Random& random) {
    RopeDef rope = crooked_rope(random, pick(random, 2, 10), any_angle(random), 1.0);
    if (pick(random, 0, 1) == 0) throw_it(random, rope);
    EstimateCase made = one_rope(random, rope, pick_real(random, 1.0, 4.0));
    made.scene.video.fps = FrameRate(Rational{pick(random, 1, 60), 1});
    made.scene.camera.follow = CameraDef::kTip;
    made.scene.camera.height_m = pick_log(random, 0.5, 4.0);
    return made;
}

}  // namespace

std::span<const EstimateFamily> look_families() {
    static const auto families = std::to_array<EstimateFamily>({{"between_frames", between_frames},
                                                                {"in_step", in_step},
                                                                {"arched_row", arched_row},
                                                                {"followed_camera", followed_camera}});
    return families;
}

}  // namespace corda::test
