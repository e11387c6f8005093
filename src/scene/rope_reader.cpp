#include <fmt/format.h>

#include "corda/scene/readers.hpp"

namespace corda::scene {
namespace {

constexpr Range kMass{.low = 1e-12, .high = 1e12};

void check_length(const Value& list, std::size_t count, std::int64_t particles, std::string_view remedy) {
    if (count == static_cast<std::size_t>(particles)) return;
    list.fail(fmt::format("{} values for {} particles; {}", count, particles, remedy));
}

double mass_of(const Value& value) {
    constexpr std::string_view kRemedy = "give a mass in kg";
    static_cast<void>(value.number(kPositive, kRemedy));
    return value.number(kMass, kRemedy);
}

void read_mass(const TableReader& rope, std::int64_t particles, std::vector<double>& mass_kg) {
    constexpr std::string_view kRemedy = "give a mass in kg, or a list with one a particle";
    const auto value = rope.find("mass");
    const auto count = static_cast<std::size_t>(particles);
    if (value && value->is_list()) {
        check_length(*value, value->size(kRemedy), particles, kRemedy);
        mass_kg.reserve(count);
        for (std::size_t i = 0; i < count; ++i) mass_kg.push_back(mass_of(value->at(i)));
    } else {
        mass_kg.assign(count, value ? mass_of(*value) : 1.0);
    }
}

void read_velocity(const TableReader& rope, std::int64_t particles, std::vector<sim::Vec2>& velocity_m_s) {
    constexpr std::string_view kRemedy = "give [vx, vy] in m/s, or a list with one such pair a particle";
    const auto value = rope.find("velocity");
    const auto count = static_cast<std::size_t>(particles);
    if (!value) {
        velocity_m_s.assign(count, {});
        return;
    }
    // [a, b] is one velocity for all; [[a, b], [c, d]] is a list, also for a rope of two particles.
    const std::size_t size = value->size(kRemedy);
    if (size == 0 || !value->at(0).is_list()) {
        velocity_m_s.assign(count, value->pair(kAnyNumber, kRemedy));
        return;
    }
    check_length(*value, size, particles, kRemedy);
    velocity_m_s.reserve(count);
    for (std::size_t i = 0; i < count; ++i) velocity_m_s.push_back(value->at(i).pair(kAnyNumber, kRemedy));
}

void read_pinned(const TableReader& rope, std::int64_t particles, std::vector<std::uint32_t>& pinned) {
    constexpr std::string_view kRemedy = "give a list of particle indices, -1 is the last";
    const auto value = rope.find("pinned");
    if (!value) return;
    pinned.clear();
    std::vector<bool> seen(static_cast<std::size_t>(particles));
    for (std::size_t i = 0; i < value->size(kRemedy); ++i) {
        const Value entry = value->at(i);
        const std::int64_t written = entry.integer(INT64_MIN, INT64_MAX, kRemedy);
        if (written < -particles || written >= particles) {
            entry.fail(
                fmt::format("{} is out of range; the rope has particles 0 .. {}, or -1 .. -{} from its end",
                            written, particles - 1, particles));
        }
        const std::int64_t index = written < 0 ? written + particles : written;
        if (seen[static_cast<std::size_t>(index)]) {
            entry.fail(fmt::format("particle {} is given twice; remove one", index));
        }
        seen[static_cast<std::size_t>(index)] = true;
        pinned.push_back(static_cast<std::uint32_t>(index));
    }
}

}  // namespace

sim::RopeDef read_rope(const TableReader& rope, std::int64_t particles, int reach) {
    sim::RopeDef def;
    read_shape(rope, particles, reach, def);
    read_mass(rope, particles, def.mass_kg);
    read_velocity(rope, particles, def.velocity_m_s);
    read_pinned(rope, particles, def.pinned);
    rope.read_number("payload", def.payload_kg, {.low = 0.0, .high = kMass.high}, "give a payload in kg");
    return def;
}

}  // namespace corda::scene
