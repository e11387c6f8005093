#include "support/estimate_families.hpp"

#include <array>
#include <cmath>
#include <numbers>
#include <utility>

namespace corda::test {
namespace {

using Real = ExtendedMotion::Real;

EstimateCase few_links(Random& random) {
    return one_rope(random, crooked_rope(random, pick(random, 2, 8), any_angle(random), 1.5), 6.0);
}

EstimateCase many_links(Random& random) {
    return one_rope(random, crooked_rope(random, pick(random, 10, 30), any_angle(random), 0.3), 3.0);
}

/// Long enough to reach a horizon.
EstimateCase chaos_few(Random& random) {
    return one_rope(random, crooked_rope(random, pick(random, 2, 8), 2.0 + pick_real(random, -0.5, 0.5), 0.5),
                    12.0);
}

EstimateCase chaos_many(Random& random) {
    const double angle = (pick(random, 0, 1) == 0 ? 1.0 : -1.0) * pick_real(random, 1.4, 3.0);
    return one_rope(random, crooked_rope(random, pick(random, 10, 30), angle, pick_log(random, 1e-6, 0.3)),
                    8.0);
}

EstimateCase straight_start(Random& random) {
    const double angle_deg = std::round(pick_real(random, 80.0, 170.0));
    EstimateCase made = straight_rope(pick(random, 2, 30), 1.0, angle_deg);
    made.scene.world.duration_s = 5.0;
    add_video(random, made.scene);
    return made;
}

EstimateCase payload(Random& random) {
    RopeDef rope = crooked_rope(random, pick(random, 2, 10), any_angle(random), 1.0);
    rope.payload_kg = pick_log(random, 1.0, 1e6);
    if (pick(random, 0, 1) == 0) rope.mass_kg.assign(rope.points_m.size(), pick_log(random, 1e-3, 1.0));
    return one_rope(random, rope, 4.0);
}

EstimateCase uneven(Random& random) {
    RopeDef rope = crooked_rope(random, pick(random, 2, 12), any_angle(random), 1.0);
    const double spread = pick_log(random, 3.0, 1e3);
    for (std::size_t i = 1; i < rope.points_m.size(); ++i)
        rope.points_m[i] = rope.points_m[i] + 0.5 * rope.points_m[i - 1];
    for (std::size_t i = 0; i < rope.points_m.size(); ++i)
        rope.mass_kg.push_back(pick_log(random, 1.0 / spread, spread));
    return one_rope(random, rope, 4.0);
}

EstimateCase two_pins(Random& random) {
    const int links = pick(random, 3, 10);
    RopeDef rope = crooked_rope(random, links, any_angle(random), 1.2);
    rope.pinned = {0, static_cast<std::uint32_t>(links)};
    return one_rope(random, rope, 4.0);
}

EstimateCase thrown(Random& random) {
    RopeDef rope = crooked_rope(random, pick(random, 2, 10), any_angle(random), 1.0);
    throw_it(random, rope);
    return one_rope(random, rope, 3.0);
}

EstimateCase weightless(Random& random) {
    RopeDef rope = crooked_rope(random, pick(random, 2, 8), any_angle(random), 1.0);
    throw_it(random, rope);
    if (pick(random, 0, 1) == 0) rope.pinned = {0};
    EstimateCase made = one_rope(random, rope, 4.0);
    made.scene.world.gravity_m_s2 = {};
    return made;
}

EstimateCase elastic(Random& random) {
    RopeDef rope = crooked_rope(random, pick(random, 1, 8), any_angle(random), 1.0);
    rope.material.compliance_1_n = pick_log(random, 1e-5, 1e-2);
    return one_rope(random, rope, 3.0);
}

/// At rest in the rope's own shape, with vibrations of all sizes.
EstimateCase elastic_straight(Random& random) {
    RopeDef rope = crooked_rope(random, pick(random, 1, 6), pick_real(random, -1.6, 1.6), 0.0);
    rope.material.compliance_1_n = pick_log(random, 1e-7, 1e-4);
    rope.mass_kg.assign(rope.points_m.size(), pick_log(random, 0.01, 10.0));
    return one_rope(random, rope, 1.0);
}

EstimateCase beam(Random& random) {
    RopeDef rope = crooked_rope(random, pick(random, 2, 5), any_angle(random), 0.3);
    rope.bending_n_m2 = pick_log(random, 0.01, 1e4);
    return one_rope(random, rope, 1.5);
}

/// Straight and stiff: fast, small vibrations.
EstimateCase beam_straight(Random& random) {
    RopeDef rope = crooked_rope(random, pick(random, 2, 4), pick_real(random, -0.3, 0.3), 0.0);
    const double length_m = pick_log(random, 0.1, 3.0);
    for (Vec2& point : rope.points_m) point = length_m * point;
    rope.mass_kg.assign(rope.points_m.size(), pick_log(random, 0.03, 1.0));
    rope.bending_n_m2 = pick_log(random, 1.0, 1e6) * length_m * length_m;
    return one_rope(random, rope, 1.5);
}

EstimateCase elastic_beam(Random& random) {
    RopeDef rope = crooked_rope(random, pick(random, 2, 5), any_angle(random), 0.5);
    rope.bending_n_m2 = pick_log(random, 0.01, 100.0);
    rope.material.compliance_1_n = pick_log(random, 1e-5, 1e-2);
    if (pick(random, 0, 2) == 0) rope.pinned = {0, 1};
    return one_rope(random, rope, 1.5);
}

}  // namespace

double pick_log(Random& random, double least, double most) {
    return std::exp(pick_real(random, std::log(least), std::log(most)));
}

double any_angle(Random& random) {
    return pick_real(random, -std::numbers::pi, std::numbers::pi);
}

void throw_it(Random& random, RopeDef& rope) {
    rope.pinned = {};
    const double turn_1_s = pick_real(random, -10.0, 10.0);
    const Vec2 all{pick_real(random, -3.0, 3.0), pick_real(random, -3.0, 3.0)};
    for (const Vec2 point : rope.points_m) rope.velocity_m_s.push_back(all + turn_1_s * left_of(point));
}

RopeDef crooked_rope(Random& random, int links, double angle, double spread) {
    RopeDef rope;
    rope.points_m = {{0.0, 0.0}};
    for (int k = 0; k < links; ++k) {
        const double turned = angle + spread * pick_real(random, -1.0, 1.0);
        rope.points_m.push_back(rope.points_m.back() +
                                1.0 / links * Vec2{std::sin(turned), -std::cos(turned)});
    }
    return rope;
}

void add_video(Random& random, Scene& scene) {
    constexpr auto kSizes =
        std::to_array<std::pair<int, int>>({{1280, 720}, {16, 16}, {640, 360}, {3840, 2160}});
    const auto& [width_px, height_px] = kSizes[static_cast<std::size_t>(pick(random, 0, 3))];
    scene.video.width_px = width_px;
    scene.video.height_px = height_px;
    const auto rates = std::to_array<Rational>({{60, 1}, {25, 1}, {30000, 1001}, {5, 1}, {50, 1}});
    scene.video.fps = FrameRate(rates[static_cast<std::size_t>(pick(random, 0, 4))]);
    if (pick(random, 0, 2) == 0) scene.solver = AutoDef{pick_log(random, 1e-7, 1.0)};
    if (pick(random, 0, 3) == 0) scene.world.drag_1_s = pick_log(random, 0.01, 1.0);
}

EstimateCase one_rope(Random& random, RopeDef rope, double duration_s) {
    EstimateCase made;
    made.scene.ropes = {std::move(rope)};
    made.scene.world.duration_s = duration_s;
    add_video(random, made.scene);
    return made;
}

EstimateCase one_net(Random& random, NetDef net, double duration_s) {
    EstimateCase made;
    made.scene.nets = {std::move(net)};
    made.scene.world.duration_s = duration_s;
    add_video(random, made.scene);
    return made;
}

EstimateCase straight_rope(int links, double length_m, double angle_deg, const std::string& more) {
    EstimateCase made{parse_scene(
        "schema = 1\n" + more + "\n[[rope]]\nhang = { links = " + std::to_string(links) +
            ", length = " + std::to_string(length_m) + ", angle_deg = " + std::to_string(angle_deg) + " }\n",
        "straight.toml")};
    const Real angle = Real{angle_deg} * std::numbers::pi_v<Real> / 180;
    for (int i = 0; i <= links; ++i) made.start.push_back(i * length_m * std::sin(angle) / links);
    for (int i = 0; i <= links; ++i) made.start.push_back(-i * length_m * std::cos(angle) / links);
    return made;
}

EstimateCase EstimateFamily::scene(unsigned n) const {
    std::vector<std::uint32_t> numbers{n};
    for (const char* letter = name; *letter != '\0'; ++letter)
        numbers.push_back(static_cast<std::uint32_t>(*letter));
    std::seed_seq seed(numbers.begin(), numbers.end());
    Random random(seed);
    return make(random);
}

std::span<const EstimateFamily> rope_families() {
    static const auto families = std::to_array<EstimateFamily>({{"few_links", few_links},
                                                                {"many_links", many_links},
                                                                {"chaos_few", chaos_few},
                                                                {"chaos_many", chaos_many},
                                                                {"straight_start", straight_start},
                                                                {"payload", payload},
                                                                {"uneven", uneven},
                                                                {"two_pins", two_pins},
                                                                {"thrown", thrown},
                                                                {"weightless", weightless},
                                                                {"elastic", elastic},
                                                                {"elastic_straight", elastic_straight},
                                                                {"beam", beam},
                                                                {"beam_straight", beam_straight},
                                                                {"elastic_beam", elastic_beam}});
    return families;
}

}  // namespace corda::test
