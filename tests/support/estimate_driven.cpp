#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "support/estimate_families.hpp"

namespace corda::test {
namespace {

Vec2 any_vector(Random& random, double length) {
    const double angle = any_angle(random);
    return {length * std::cos(angle), length * std::sin(angle)};
}

/// One or two waves of up to 20 Hz, which accelerate a pin by at most some hundred m/s^2.
std::vector<WaveDef> any_waves(Random& random) {
    std::vector<WaveDef> waves;
    for (int count = pick(random, 1, 2); count > 0; --count) {
        const double frequency_hz = pick_log(random, 0.2, 20.0);
        const double most_m = std::min(0.5, 5.0 / (frequency_hz * frequency_hz));
        waves.push_back({any_vector(random, most_m * pick_log(random, 0.02, 1.0)), frequency_hz,
                         pick_real(random, -180.0, 180.0)});
    }
    return waves;
}

/// Two to four keys, some of them after a rest, some of a wait.
std::vector<PathKeyDef> any_path(Random& random) {
    std::vector<PathKeyDef> path{{pick(random, 0, 1) == 0 ? 0.0 : pick_real(random, 0.0, 0.5), {}}};
    for (int count = pick(random, 1, 3); count > 0; --count) {
        const Vec2 by_m =
            pick(random, 0, 4) == 0 ? path.back().by_m : any_vector(random, pick_log(random, 0.05, 2.0));
        path.push_back({path.back().time_s + pick_log(random, 0.2, 2.0), by_m});
    }
    return path;
}

MoveDef any_move(Random& random, std::uint32_t pin) {
    switch (pick(random, 0, 2)) {
        case 0:
            return {pin, any_waves(random), {}};
        case 1:
            return {pin, {}, any_path(random)};
        default:
            return {pin, any_waves(random), any_path(random)};
    }
}

/// Rigid, elastic, a string, or one that resists bending.
RopeDef any_rope(Random& random, int most_links) {
    RopeDef rope = crooked_rope(random, pick(random, 1, most_links), any_angle(random), 1.0);
    switch (pick(random, 0, 5)) {
        case 0:
            rope.material.compliance_1_n = pick_log(random, 1e-5, 1e-2);
            break;
        case 1:
            rope.material.is_string = true;
            break;
        case 2:
            rope.bending_n_m2 = pick_log(random, 0.01, 10.0);
            break;
        default:
            break;
    }
    if (pick(random, 0, 3) == 0) rope.payload_kg = pick_log(random, 1.0, 100.0);
    return rope;
}

/// One pin, which waves move.
EstimateCase drive(Random& random) {
    RopeDef rope = any_rope(random, 8);
    rope.moves = {{0, any_waves(random), {}}};
    return one_rope(random, rope, 3.0);
}

/// One pin on a path.
EstimateCase crane(Random& random) {
    RopeDef rope = any_rope(random, 8);
    rope.moves = {{0, {}, any_path(random)}};
    return one_rope(random, rope, 3.0);
}

/// Steady wind and gusts, also on a rope in the air.
EstimateCase wind(Random& random) {
    RopeDef rope = any_rope(random, 8);
    if (pick(random, 0, 4) == 0 && !rope.material.is_string) throw_it(random, rope);
    EstimateCase made = one_rope(random, rope, 4.0);
    WorldDef& world = made.scene.world;
    world.drag_1_s = pick_log(random, 0.01, 5.0);
    world.wind_m_s = any_vector(random, pick_log(random, 0.1, 20.0));
    if (pick(random, 0, 3) != 0)
        world.gusts = {any_vector(random, pick_log(random, 0.1, 20.0)), pick_log(random, 0.05, 20.0),
                       pick_real(random, -180.0, 180.0)};
    return made;
}

/// Pins that move differently or alike, of ropes that stretch and of rigid ones.
EstimateCase two_moving_pins(Random& random) {
    const int links = pick(random, 3, 8);
    RopeDef rope = crooked_rope(random, links, any_angle(random), 1.2);
    const auto last = static_cast<std::uint32_t>(links);
    rope.pinned = {0, last};
    rope.moves = {any_move(random, 0), any_move(random, last)};
    if (pick(random, 0, 2) == 0) {
        rope.moves.back() = rope.moves.front();
        rope.moves.back().pin = last;
    } else if (pick(random, 0, 2) == 0) {
        if (pick(random, 0, 3) == 0) rope.moves.pop_back();
    } else {
        rope.material.compliance_1_n = pick_log(random, 1e-4, 1e-2);
        rope.material.is_string = pick(random, 0, 2) == 0;
        if (pick(random, 0, 3) == 0) rope.moves.pop_back();
    }
    return one_rope(random, rope, 2.0);
}

/// A net on one pin that moves, rigid or not, or a net that stretches between pins that move differently.
EstimateCase moving_net(Random& random) {
    NetDef net;
    const int columns = pick(random, 2, 3);
    const int rows = pick(random, 2, 4);
    for (int row = 0; row < rows; ++row) {
        for (int column = 0; column < columns; ++column) {
            const auto at = static_cast<std::uint32_t>(net.points_m.size());
            net.points_m.push_back({0.3 * column + 0.1 * row + 0.03 * pick_real(random, -1.0, 1.0),
                                    -0.3 * row + 0.03 * pick_real(random, -1.0, 1.0)});
            if (column > 0) net.bars.push_back({at - 1, at});
            if (row > 0) net.bars.push_back({at - static_cast<std::uint32_t>(columns), at});
        }
    }
    net.pinned = {0};
    net.moves = {any_move(random, 0)};
    if (pick(random, 0, 2) != 0) {
        net.material.compliance_1_n = pick_log(random, 1e-4, 1e-2);
        net.material.is_string = pick(random, 0, 2) == 0;
        if (pick(random, 0, 1) == 0) {
            const auto other = static_cast<std::uint32_t>(net.points_m.size() - 1);
            net.pinned.push_back(other);
            net.moves.push_back(any_move(random, other));
        }
    }
    return one_net(random, net, 0.7);
}

}  // namespace

std::span<const EstimateFamily> driven_families() {
    static const auto families = std::to_array<EstimateFamily>({{"drive", drive},
                                                                {"crane", crane},
                                                                {"wind", wind},
                                                                {"two_moving_pins", two_moving_pins},
                                                                {"moving_net", moving_net}});
    return families;
}

}  // namespace corda::test
