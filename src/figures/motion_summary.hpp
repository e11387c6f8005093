#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "corda/core/basics.hpp"
#include "corda/figures/thinning.hpp"
#include "corda/pipeline/film.hpp"
#include "corda/pipeline/tracked_particle.hpp"

namespace corda::figures {

/// The largest size of a quantity, when and where it was.
struct Extreme {
    bool is_known = false;
    double size = 0.0;
    double time_s = 0.0;
    std::size_t body = 0;
    std::size_t index = 0;  ///< of the link or the particle, among its body's

    /// NaN does not count.
    void include(double value, double at_s, std::size_t of_body, std::size_t at);
    void include(const Extreme& other);
};

/// The curves of one body.
struct BodyCurves {
    BodyCurves(const pipeline::TrackedParticle& whom, std::int64_t rows)
        : followed(whom),
          path(rows, Thinner::Kind::kPath),
          phase(rows, Thinner::Kind::kPath),
          turning(rows, Thinner::Kind::kPath),
          tension(rows),
          strain(rows) {}

    pipeline::TrackedParticle followed;
    Thinner path;     ///< x and y in m, relative to the system's origin
    Thinner phase;    ///< x in m from the only pin, or else from the start, and vx in m/s
    Thinner turning;  ///< angle of the way from the only pin, in rad from straight down, turns counted on,
                      ///< and its rate in rad/s; no points without such a pin
    Thinner tension;  ///< the largest of a link, in N, over time; NaN if the method does not know it
    Thinner strain;   ///< the largest of a link over time
    double nearest_m = std::numeric_limits<double>::infinity();  ///< to that pin
};

/// Summary of a motion for a report, from its states at all frame times.
struct MotionSummary {
    explicit MotionSummary(std::int64_t most) : kinetic(most), weight(most), elastic(most), total(most) {}

    std::int64_t rows = 0;
    double end_s = 0.0;  ///< of the last row
    std::vector<BodyCurves> bodies;
    // Energies over time in J. That of the weight is 0 at the start, and so counted in the total.
    Thinner kinetic;
    Thinner weight;
    Thinner elastic;
    Thinner total;
    bool is_elastic = false;  ///< whether anything stretches or bends
    Extreme tension;          ///< of all bodies, like the next two
    Extreme strain;
    Extreme speed;
    std::vector<std::size_t> unknown_tensions;  ///< bodies whose method told none, ascending
    std::vector<double> tensions_n;             ///< of the links of the body with the largest, at its time
    /// kDiverged: why there are no more rows.
    std::optional<Error> failure;
};

/// Fields that the states of the film need: FilmDef::readings.
[[nodiscard]] StateFields needed_readings();

/// Where rows go: a file name and the keys of its columns give what takes its rows.
using OnRow = std::function<void(std::span<const double> values)>;
using OpenRows = std::function<OnRow(const std::string& name, const std::vector<std::string>& keys)>;

/// Reads the states at all frame times once, and hands all rows of tip.csv, energy.csv, tension.csv and
/// strain.csv to `open`. A motion that diverges ends the reading early. Throws corda::Error: kInterrupted if
/// cancelled, kDiverged if there is not even a start, and what `open` throws.
[[nodiscard]] MotionSummary read_motion(Film& film, const OpenRows& open, const OnProgress& on_progress);

}  // namespace corda::figures
