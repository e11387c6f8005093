#include <fmt/format.h>

#include "corda/scene/readers.hpp"

namespace corda::scene {
namespace {

constexpr Range kCompliance{.low = 0.0, .high = 1e6};

void check_length(const Value& list, std::size_t count, std::int64_t particles, std::string_view remedy) {
    if (count == static_cast<std::size_t>(particles)) return;
    list.fail(fmt::format("{} values for {} particles; {}", count, particles, remedy));
}

double mass_of(const Value& value) {
    constexpr std::string_view kRemedy = "give a mass in kg";
    static_cast<void>(value.number(kPositive, kRemedy));
    return value.number(kMass, kRemedy);
}

}  // namespace

std::vector<double> read_mass(const TableReader& body, std::int64_t particles) {
    constexpr std::string_view kRemedy = "give a mass in kg, or a list with one a particle";
    const auto value = body.find("mass");
    const auto count = static_cast<std::size_t>(particles);
    if (!value || !value->is_list()) return std::vector<double>(count, value ? mass_of(*value) : 1.0);
    check_length(*value, value->size(kRemedy), particles, kRemedy);
    std::vector<double> mass_kg;
    mass_kg.reserve(count);
    for (std::size_t i = 0; i < count; ++i) mass_kg.push_back(mass_of(value->at(i)));
    return mass_kg;
}

std::vector<sim::Vec2> read_velocity(const TableReader& body, std::int64_t particles) {
    constexpr std::string_view kRemedy = "give [vx, vy] in m/s, or a list with one such pair a particle";
    const auto value = body.find("velocity");
    const auto count = static_cast<std::size_t>(particles);
    if (!value) return std::vector<sim::Vec2>(count);
    // [a, b] is one velocity for all; [[a, b], [c, d]] is a list, also for a body of two particles.
    const std::size_t size = value->size(kRemedy);
    if (size == 0 || !value->at(0).is_list()) {
        return std::vector<sim::Vec2>(count, value->pair(kAnyNumber, kRemedy));
    }
    check_length(*value, size, particles, kRemedy);
    std::vector<sim::Vec2> velocity_m_s;
    velocity_m_s.reserve(count);
    for (std::size_t i = 0; i < count; ++i) velocity_m_s.push_back(value->at(i).pair(kAnyNumber, kRemedy));
    return velocity_m_s;
}

sim::MaterialDef read_material(const TableReader& body) {
    sim::MaterialDef def;
    body.read_number("compliance", def.compliance_1_n, kCompliance,
                     "give a strain per newton in 1/N, 0 for bars that do not stretch");
    if (const auto value = body.find("string")) def.is_string = value->boolean("give true or false");
    return def;
}

std::int64_t read_index(const Value& entry, std::int64_t count, std::string_view owner,
                        std::string_view remedy) {
    const std::int64_t written = entry.integer(INT64_MIN, INT64_MAX, remedy);
    if (written < -count || written >= count) {
        entry.fail(fmt::format("{} is out of range; {} 0 .. {}, or -1 .. -{} from its end", written, owner,
                               count - 1, count));
    }
    return written < 0 ? written + count : written;
}

std::vector<std::uint32_t> read_pinned(const Value& list, std::int64_t particles, std::string_view remedy,
                                       const std::function<std::int64_t(const Value&)>& index_of) {
    std::vector<std::uint32_t> pinned;
    std::vector<bool> seen(static_cast<std::size_t>(particles));
    for (std::size_t i = 0; i < list.size(remedy); ++i) {
        const Value entry = list.at(i);
        const std::int64_t index = index_of(entry);
        if (seen[static_cast<std::size_t>(index)]) {
            entry.fail(fmt::format("particle {} is given twice; remove one", index));
        }
        seen[static_cast<std::size_t>(index)] = true;
        pinned.push_back(static_cast<std::uint32_t>(index));
    }
    return pinned;
}

}  // namespace corda::scene
