#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "corda/core/basics.hpp"
#include "corda/pipeline/film.hpp"
#include "corda/pipeline/tracked_particle.hpp"
#include "corda/view/plot_panel.hpp"

namespace corda::figures {

using CurvePoints = std::vector<view::CurvePoint>;

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

struct BodyCurves {
    pipeline::TrackedParticle followed;
    CurvePoints path = {};   ///< x and y in m, relative to the system's origin
    CurvePoints phase = {};  ///< x in m from the only pin, or else from the start, and vx in m/s
    /// Angle of the way from the only pin, in rad from straight down, turns counted on, and its rate in
    /// rad/s; no points without such a pin.
    CurvePoints turning = {};
    CurvePoints tension = {};  ///< the largest of a link, in N, over time; NaN if the method does not know it
    CurvePoints strain = {};   ///< the largest of a link over time
    double nearest_m = std::numeric_limits<double>::infinity();  ///< to that pin
};

/// Summary of a motion for a report, from its states at all frame times; paths, phases and turnings have
/// more.
struct MotionSummary {
    std::int64_t rows = 0;
    double end_s = 0.0;  ///< of the last row
    std::vector<BodyCurves> bodies;
    // Energies over time in J. That of the weight is 0 at the start, and so counted in the total.
    CurvePoints kinetic;
    CurvePoints weight;
    CurvePoints elastic;
    CurvePoints total;
    bool is_elastic = false;  ///< whether anything stretches or bends
    Extreme tension;          ///< of all bodies, like the next two
    Extreme strain;
    Extreme speed;
    std::vector<std::size_t> unknown_tensions;  ///< bodies whose method told none, ascending
    std::vector<double> tensions_n;             ///< of the links of the body with the largest, at its time
    std::vector<double> periods_s;              ///< of the first body (SummaryReader)
    std::optional<double> angle_max_deg;        ///< of the first body
    /// kDiverged: why there are no more rows.
    std::optional<Error> failure;
};

/// How the film of a report records its motion: with the fields that the report reads, and several times per
/// frame if the frames are few, so that paths are smooth.
[[nodiscard]] FilmDef film_def(const Scene& scene);

/// Where rows go: a file name and the keys of its columns give what takes its rows.
using OnRow = std::function<void(std::span<const double> values)>;
using OpenRows = std::function<OnRow(const std::string& name, const std::vector<std::string>& keys)>;

/// Reads the states of a film with film_def() once, and hands all rows of tip.csv, energy.csv, tension.csv
/// and strain.csv to `open`, one per frame time. A motion that diverges ends the reading early. Throws
/// corda::Error: kInterrupted if cancelled, kDiverged if there is not even a start, and what `open` throws.
[[nodiscard]] MotionSummary read_motion(Film& film, const OpenRows& open, const OnProgress& on_progress);

/// The period of a scene by theory.
struct PeriodTheory {
    double period_s = 0.0;
    std::string model;  ///< "a point pendulum of this amplitude"
};

/// The theory of a scene that swings through `angle_deg`: of a point pendulum (R2), of a rigid rod (R3),
/// which bars to more than the next particle make of a rope, or of a hanging rope at small angles (R4). The
/// rope hangs from its first particle, without drag, and has equal masses and links. std::nullopt for other
/// scenes.
[[nodiscard]] std::optional<PeriodTheory> period_theory(const Scene& scene, double angle_deg);

}  // namespace corda::figures
