#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "corda/core/basics.hpp"
#include "corda/core/text.hpp"
#include "corda/sim/simulation.hpp"

namespace corda {
namespace {

[[noreturn]] void fail(const std::string& source, std::string key, std::string what, std::string remedy) {
    throw Error(ExitCode::kUsage,
                Problem{{.source = source, .key = std::move(key)}, std::move(what), std::move(remedy)});
}

void check_times(const std::vector<double>& times_s, const std::string& source) {
    if (times_s.size() < 2) fail(source, "times", counted(std::ssize(times_s), "time"), "give at least two");
    const auto key = [](std::size_t k) { return fmt::format("times[{}]", k); };
    for (std::size_t k = 0; k < times_s.size(); ++k) {
        if (!std::isfinite(times_s[k]))
            fail(source, key(k), fmt::format("{} is not a finite number", times_s[k]), "give times in s");
        if (k > 0 && times_s[k] - times_s[k - 1] < GivenMotion::kMinIntervalSeconds)
            fail(source, key(k), fmt::format("{} s comes after {} s", times_s[k], times_s[k - 1]),
                 "give times that increase, by 1e-9 s or more");
    }
    if (times_s.front() > 0.0)
        fail(source, key(0), fmt::format("the first time is {} s, and a film starts at 0 s", times_s.front()),
             "subtract it from all times, or add the positions at 0 s");
    if (times_s.back() <= 0.0)
        fail(source, key(times_s.size() - 1),
             fmt::format("the last time is {} s, and a film starts at 0 s", times_s.back()),
             "subtract the first time from all times, or add positions at later ones");
}

void check_positions(const std::vector<Vec2>& positions_m, std::size_t times, const std::string& source) {
    if (positions_m.empty() || positions_m.size() % times != 0)
        fail(source, "positions", fmt::format("{} positions at {} times", positions_m.size(), times),
             "give one per particle and time");
    const std::size_t particles = positions_m.size() / times;
    for (std::size_t k = 0; k < positions_m.size(); ++k) {
        const Vec2 at = positions_m[k];
        if (std::max(std::abs(at.x), std::abs(at.y)) <= kMaxCoordinateMetres && !std::isnan(at.x + at.y))
            continue;
        fail(source, fmt::format("positions[{}][{}]", k / particles, k % particles),
             fmt::format("[{}, {}] is not within -1e12 .. 1e12 m", at.x, at.y), "give finite positions in m");
    }
}

std::string_view bytes_of(const auto& numbers) {
    return {reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(numbers[0])};
}

}  // namespace

GivenMotion::GivenMotion(std::vector<double> times_s, std::vector<Vec2> positions_m, std::string source)
    : times_s_(std::move(times_s)), positions_m_(std::move(positions_m)), source_(std::move(source)) {
    check_times(times_s_, source_);
    check_positions(positions_m_, times_s_.size(), source_);
    particle_count_ = positions_m_.size() / times_s_.size();
    hash_ = hash_text(hash_text(bytes_of(times_s_)) + hash_text(bytes_of(positions_m_)));
}

/// From time k to the next.
Vec2 GivenMotion::mean_velocity_m_s(std::size_t k, std::size_t i) const {
    return 1.0 / (times_s_[k + 1] - times_s_[k]) * (position_m(k + 1, i) - position_m(k, i));
}

Vec2 GivenMotion::velocity_m_s(std::size_t k, std::size_t i) const {
    const std::size_t last = times_s_.size() - 1;
    if (last == 1) return mean_velocity_m_s(0, i);
    const std::size_t middle = std::clamp<std::size_t>(k, 1, last - 1);
    const Vec2 before = mean_velocity_m_s(middle - 1, i);
    const Vec2 after = mean_velocity_m_s(middle, i);
    const Vec2 half_acceleration = 1.0 / (times_s_[middle + 1] - times_s_[middle - 1]) * (after - before);
    const double since_mean_s =
        times_s_[middle] - times_s_[middle - 1] + 2.0 * (times_s_[k] - times_s_[middle]);
    return before + since_mean_s * half_acceleration;
}

bool GivenMotion::moves_before(double until_s, std::size_t particle) const {
    for (std::size_t k = 1; k < times_s_.size() && times_s_[k] < until_s; ++k)
        if (position_m(k, particle) != position_m(0, particle)) return true;
    return false;
}

State GivenMotion::at(double time_s) const {
    if (!(time_s >= times_s_.front()))
        throw_usage("{} is given from {} s on, and has no state at {} s", source_, times_s_.front(), time_s);
    const auto after = std::ranges::lower_bound(times_s_, time_s);
    const std::size_t end = std::min<std::size_t>(after - times_s_.begin(), times_s_.size() - 1);
    const bool is_given = after == times_s_.end() || *after == time_s;
    State state{time_s, {}, {}};
    const auto add = [&state](Vec2 at_m, Vec2 velocity_m_s) {
        state.x_m.push_back(at_m.x);
        state.y_m.push_back(at_m.y);
        state.vx_m_s.push_back(velocity_m_s.x);
        state.vy_m_s.push_back(velocity_m_s.y);
    };
    for (std::size_t i = 0; i < particle_count_; ++i) {
        if (is_given) {
            add(position_m(end, i), after == times_s_.end() ? Vec2{} : velocity_m_s(end, i));
            continue;
        }
        const double interval_s = times_s_[end] - times_s_[end - 1];
        const double s = (time_s - times_s_[end - 1]) / interval_s;
        const Vec2 from = position_m(end - 1, i);
        const Vec2 way = position_m(end, i) - from;
        const Vec2 early = interval_s * velocity_m_s(end - 1, i) - way;
        const Vec2 late = way - interval_s * velocity_m_s(end, i);
        const Vec2 bend = (1.0 - s) * early + s * late;
        add(from + s * way + s * (1.0 - s) * bend,
            1.0 / interval_s * (way + (1.0 - 2.0 * s) * bend + s * (1.0 - s) * (late - early)));
    }
    return state;
}

}  // namespace corda
