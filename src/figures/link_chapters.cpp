#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "corda/figures/chapters.hpp"
#include "corda/figures/chart.hpp"
#include "corda/figures/quantity_text.hpp"
#include "corda/pipeline/plan_text.hpp"
#include "corda/sim/solver.hpp"

namespace corda::figures {
namespace {

/// "link 3 of rope 0 (between its particles 3 and 4)"
std::string link_text(const System& system, const Extreme& extreme) {
    const Body& body = system.bodies[extreme.body];
    const Bar& bar = system.bars[body.first_bar + extreme.index];
    return fmt::format("link {} of {}, between its particles {} and {}", extreme.index,
                       body_name(system, extreme.body), bar.a - body.first_particle,
                       bar.b - body.first_particle);
}

/// Why the tensions of some bodies are not known.
std::string unknown_text(const Film& film, const MotionSummary& reading) {
    const auto relaxes = [&](std::size_t b) { return !sim::knows_tensions(film.plan().bodies[b].method); };
    const auto& bodies = reading.unknown_tensions;
    const std::string names = bodies_text(film.system(), bodies);
    if (std::all_of(bodies.begin(), bodies.end(), relaxes)) {
        return fmt::format(
            "Tensions of {} are not known: method relaxation moves particles until bars have "
            "their lengths, without forces in them.",
            names);
    }
    return fmt::format(
        "Tensions of {} are not known: bars that depend on each other share them in any way{}.", names,
        std::any_of(bodies.begin(), bodies.end(), relaxes) ? ", and method relaxation knows no forces in bars"
                                                           : "");
}

/// The tensions of the links of a chain or a ring when the largest of all is reached.
void add_tensions_along(const Film& film, const MotionSummary& reading, report::Chapter& chapter) {
    const System& system = film.system();
    const Body& body = system.bodies[reading.tension.body];
    constexpr std::size_t kMinLinks = 3;
    if (body.is_net || body.link_count < kMinLinks) return;
    Thinner thinner(static_cast<std::int64_t>(body.link_count));
    double at_m = 0.0;
    for (std::size_t k = 0; k < body.link_count; ++k) {
        const double rest_m = system.bars[body.first_bar + k].rest_m;
        const double middle_m = at_m + 0.5 * rest_m;
        thinner.add({middle_m, middle_m, reading.tensions_n[k]});
        at_m += rest_m;
    }
    const std::string name = body_name(system, reading.tension.body);
    report::Plot plot = make_plot("tension_along", "Tension along the rope", {"distance along the rope", "m"},
                                  {"tension", "N"}, {{"", thinner.points()}});
    plot.caption = fmt::format(
        "Tension of the links of {} at {}, when that of one is largest, against the "
        "distance of their middles from particle 0 along the rope at rest.",
        name, time_text(reading.tension.time_s));
    plot.data = "tension_along.csv";
    chapter.plots.push_back(plot);
}

}  // namespace

report::Chapter energy_chapter(const Film& film, const MotionSummary& reading) {
    report::Chapter chapter;
    chapter.title = "Energy";
    const auto error = film.diagnostics().largest.energy_error;
    chapter.summary = error ? fmt::format(
                                  "The energy error, | E - E(0) | over the sum of weight times length of all "
                                  "bodies, or over E(0) without a force, is at most {}.",
                                  quantity_text(*error, ""))
                            : "Damping takes energy on purpose, so there is no energy error to tell.";
    std::vector<Curve> curves{{"kinetic", reading.kinetic.points()}, {"weight", reading.weight.points()}};
    if (reading.is_elastic) curves.push_back({"elastic", reading.elastic.points()});
    curves.push_back({"total", reading.total.points(), "#000000"});
    report::Plot plot = make_plot("energy", "Energy over time", {"t", "s"}, {"energy", "J"}, curves);
    plot.caption = fmt::format(
        "Energy of all free particles over time: kinetic, that of the weight since the "
        "start{}, and their sum.{}",
        reading.is_elastic ? ", elastic" : "", thinning_text(reading));
    plot.data = "energy.csv";
    chapter.plots.push_back(plot);
    return chapter;
}

report::Chapter tension_chapter(const Film& film, const MotionSummary& reading) {
    report::Chapter chapter;
    chapter.title = "Tension";
    if (!reading.unknown_tensions.empty()) chapter.paragraphs.push_back(unknown_text(film, reading));
    const Extreme& largest = reading.tension;
    if (!largest.is_known) {
        if (!chapter.paragraphs.empty()) chapter.summary = chapter.paragraphs.front();
        return chapter;
    }
    const System& system = film.system();
    chapter.summary = fmt::format("The largest tension is {} at {} ({}).", quantity_text(largest.size, "N"),
                                  time_text(largest.time_s), link_text(system, largest));
    std::vector<Curve> curves = curves_of(film.scene(), system, reading, &BodyCurves::tension);
    std::erase_if(curves, [](const Curve& curve) {
        return std::all_of(curve.points.begin(), curve.points.end(),
                           [](const CurvePoint& point) { return std::isnan(point.y); });
    });
    if (!curves.empty()) {
        report::Plot plot =
            make_plot("tension", "Largest tension over time", {"t", "s"}, {"largest tension", "N"}, curves);
        plot.caption = fmt::format(
            "Largest tension of a link{} over time; one that pushes counts by the size "
            "of its force.{}{}",
            curves.size() > 1 ? " of each body" : "", left_out_text(system, reading), thinning_text(reading));
        plot.data = "tension.csv";
        chapter.plots.push_back(plot);
    }
    add_tensions_along(film, reading, chapter);
    return chapter;
}

report::Chapter strain_chapter(const Film& film, const MotionSummary& reading) {
    report::Chapter chapter;
    chapter.title = "Strain";
    const System& system = film.system();
    const Extreme& largest = reading.strain;
    const bool stretches = std::any_of(system.bodies.begin(), system.bodies.end(),
                                       [](const Body& body) { return body.material.compliance_1_n > 0.0; });
    if (largest.is_known) {
        chapter.summary = fmt::format(
            "The largest strain, | length / rest length - 1 |, is {} at {} ({}){}.",
            quantity_text(largest.size, ""), time_text(largest.time_s), link_text(system, largest),
            stretches ? "" : ": an error of the method, for the links are not to stretch");
    }
    const std::vector<Curve> curves = curves_of(film.scene(), system, reading, &BodyCurves::strain);
    if (curves.empty()) return chapter;
    report::Plot plot =
        make_plot("strain", "Largest strain over time", {"t", "s"}, {"largest strain", ""}, curves);
    plot.caption = fmt::format(
        "Largest strain of a link{} over time; a slack link of a string counts as 0.{}{}",
        curves.size() > 1 ? " of each body" : "", left_out_text(system, reading), thinning_text(reading));
    plot.data = "strain.csv";
    chapter.plots.push_back(plot);
    return chapter;
}

}  // namespace corda::figures
