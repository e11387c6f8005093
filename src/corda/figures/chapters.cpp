#include "corda/figures/chapters.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "corda/core/text.hpp"
#include "corda/figures/chart.hpp"
#include "corda/pipeline/plan_text.hpp"
#include "corda/sim/solver.hpp"
#include "corda/view/colors.hpp"

namespace corda::figures {
namespace {

/// Adds a plot whose numbers are in a file of that name.
void add_plot(report::Plot plot, const char* data, report::Chapter& chapter) {
    plot.data = data;
    chapter.plots.push_back(std::move(plot));
}

std::string model_text(const Film& film) {
    const std::vector<std::string> terms = modelled_terms(film.scene(), film.plan());
    return fmt::format("Modelled: {}; {}.", system_text(film.system()), fmt::join(terms, "; "));
}

std::string method_text(Film& film) {
    const Plan& plan = film.plan();
    std::string text = fmt::format("Method: {}", plan_text(film.system(), plan));
    const std::vector<MethodGroup> groups = groups_of(plan);
    if (groups.size() == 1) text += ", because " + reason_text(plan.bodies[groups.front().bodies.front()]);
    text += ". ";
    if (const auto estimate = error_estimate_text(film)) {
        text += fmt::format(
            "The error estimate of the displayed positions is {}{}.", *estimate,
            plan.horizon_s
                ? "; after that the motion cannot be predicted, and the figures show one possible motion"
                : ", from tighter runs");
    } else if (plan.horizon_s) {
        text += "The motion cannot be predicted: the figures show one possible motion.";
    } else {
        text += "There is no estimate of its error.";
    }
    return text;
}

std::string place_of(const Film& film, const Extreme& extreme, const char* what) {
    return fmt::format("{} {} of {}", what, extreme.index, body_name(film.system(), extreme.body));
}

report::Table largest_table(const Film& film, const MotionSummary& motion) {
    report::Table table{
        "largest",
        "Largest figures, at frame times",
        {{"quantity", "quantity"}, {"size", "size"}, {"unit", "unit"}, {"t_s", "t [s]"}, {"where", "where"}},
        {},
        "Links and particles are numbered from 0 within their bodies."};
    const auto add = [&](const char* name, const char* unit, const Extreme& extreme, const char* what) {
        if (!extreme.is_known) return;
        table.add({name, extreme.size, unit, extreme.time_s, place_of(film, extreme, what)});
    };
    add("speed", "m/s", motion.speed, "particle");
    add("tension", "N", motion.tension, "link");
    add("strain", "", motion.strain, "link");
    const Figures& largest = film.diagnostics().largest;
    if (largest.loads) table.add({"force on a pin", largest.loads->pin_force_n, "N", {}, {}});
    if (largest.energy_error) table.add({"energy error", *largest.energy_error, "", {}, {}});
    return table;
}

std::string times_text(const std::vector<double>& times_s) {
    std::string text;
    for (std::size_t i = 0; i < times_s.size(); ++i)
        text += fmt::format("{}{:.4g}", i == 0 ? "" : i + 1 == times_s.size() ? " and " : ", ", times_s[i]);
    return text + " s";
}

void add_pictures(const Film& film, const FigureTimes& times, const WritePoses& write,
                  report::Chapter& chapter) {
    const std::string name = printable(film.scene().name);
    const Ground ground = view::look_of(film.scene().style).ground;
    const bool is_on_white = !shows_on_white(ground.top) && !shows_on_white(ground.bottom);
    if (times.strobe_s.size() > 1) {
        const std::vector<double> times_s = times.strobe_s;
        const std::string poses = fmt::format("poses at t = {}", times_text(times_s));
        chapter.pictures.push_back(
            {"strobe", fmt::format("{}, {}", name, poses),
             fmt::format("Strobe: {}, the fainter the earlier{}.", poses,
                         times.is_swing ? "; the last is where the first swing ends" : ""),
             [write, times_s](const std::string& path, double width_mm) { write(path, width_mm, times_s); },
             false, is_on_white});
    }
    std::size_t number = 1;
    for (const double time_s : times.stills_s) {
        const std::string at = "at t = " + time_text(time_s);
        chapter.pictures.push_back(
            {fmt::format("still_{}", number++), fmt::format("{} {}", name, at),
             fmt::format("The scene {}.", at),
             [write, time_s](const std::string& path, double width_mm) { write(path, width_mm, {time_s}); },
             times.stills_s.size() > 1, is_on_white});
    }
}

constexpr const char* kTipData = "tip.csv";

std::vector<pipeline::TrackedParticle> followed_of(const MotionSummary& motion) {
    std::vector<pipeline::TrackedParticle> followed;
    for (const BodyCurves& body : motion.bodies) followed.push_back(body.followed);
    return followed;
}

/// How many bodies turn about their pins: near a point, the angle about it has no meaning.
std::ptrdiff_t turning_count(const System& system, const MotionSummary& motion) {
    return std::ranges::count_if(motion.bodies, [&](const BodyCurves& body) {
        const double length_m = links_length_m(system, system.bodies[body.followed.body]);
        return body.followed.pin && body.followed.is_free_end &&
               body.nearest_m >= pipeline::kNearPin * length_m;
    });
}

/// "The period is 2.006 s, the mean of 9 between 2.005 and 2.007 s; that of ... is 2.006 s."
std::string period_text(const Scene& scene, const MotionSummary& motion) {
    const std::vector<double>& all_s = motion.periods_s;
    if (all_s.empty())
        return fmt::format(
            "No period is measured: the film of {:g} s has no whole one between passes below "
            "the pin.",
            scene.world.duration_s);
    const auto [least, most] = std::ranges::minmax_element(all_s);
    const double mean_s =
        std::accumulate(all_s.begin(), all_s.end(), 0.0) / static_cast<double>(all_s.size());
    const std::string least_text = fmt::format("{:.5g}", *least);
    const std::string most_text = fmt::format("{:.5g}", *most);
    const char* const whose = motion.bodies.size() > 1 ? " of the first body" : "";
    std::string text = fmt::format("The period{} is {:.5g} s", whose, mean_s);
    if (all_s.size() > 1)
        text = least_text == most_text
                   ? fmt::format("The film has {} periods{} of {} s each", all_s.size(), whose, most_text)
                   : fmt::format("{}, the mean of {} between {} and {} s", text, all_s.size(), least_text,
                                 most_text);
    const auto theory = period_theory(scene, motion.angle_max_deg.value_or(180.0));
    return theory ? fmt::format("{}; that of {} is {:.5g} s.", text, theory->model, theory->period_s)
                  : text + "; no theory in this report has a period for such a scene.";
}

/// "link 3 of rope 0 (between its particles 3 and 4)"
std::string link_text(const System& system, const Extreme& extreme) {
    const Body& body = system.bodies[extreme.body];
    const Bar& bar = system.bars[body.first_bar + extreme.index];
    return fmt::format("link {} of {}, between its particles {} and {}", extreme.index,
                       body_name(system, extreme.body), bar.a - body.first_particle,
                       bar.b - body.first_particle);
}

/// Why the tensions of some bodies are not known.
std::string unknown_text(const Film& film, const MotionSummary& motion) {
    const auto relaxes = [&](std::size_t b) { return !sim::knows_tensions(film.plan().bodies[b].method); };
    const auto& bodies = motion.unknown_tensions;
    const std::string names = bodies_text(film.system(), bodies);
    if (std::ranges::all_of(bodies, relaxes)) {
        return fmt::format(
            "Tensions of {} are not known: method relaxation moves particles until bars have "
            "their lengths, without forces in them.",
            names);
    }
    return fmt::format(
        "Tensions of {} are not known: bars that depend on each other share them in any way{}.", names,
        std::ranges::any_of(bodies, relaxes) ? ", and method relaxation knows no forces in bars" : "");
}

/// The tensions of the links of a chain or a ring when the largest of all is reached.
void add_tensions_along(const Film& film, const MotionSummary& motion, report::Chapter& chapter) {
    const System& system = film.system();
    const Body& body = system.bodies[motion.tension.body];
    constexpr std::size_t kMinLinks = 3;
    if (body.is_net || body.link_count < kMinLinks) return;
    CurvePoints points;
    double at_m = 0.0;
    for (std::size_t k = 0; k < body.link_count; ++k) {
        const double rest_m = system.bars[body.first_bar + k].rest_m;
        const double middle_m = at_m + 0.5 * rest_m;
        points.push_back({middle_m, middle_m, motion.tensions_n[k]});
        at_m += rest_m;
    }
    const std::string name = body_name(system, motion.tension.body);
    report::Plot plot = make_plot("tension_along", "Tension along the rope", {"distance along the rope", "m"},
                                  {"tension", "N"}, {{"", points}});
    plot.caption = fmt::format(
        "Tension of the links of {} at {}, when that of one is largest, against the "
        "distance of their middles from particle 0 along the rope at rest.",
        name, time_text(motion.tension.time_s));
    add_plot(std::move(plot), "tension_along.csv", chapter);
}

}  // namespace

report::Chapter motion_chapter(Film& film, const MotionSummary& motion, const FigureTimes& times,
                               const WritePoses& write) {
    report::Chapter chapter{.title = "Motion"};
    chapter.summary = model_text(film) + " " + method_text(film);
    const Rational fps = film.scene().video.scene_rate().rational();
    chapter.paragraphs.push_back(
        fmt::format("All numbers are at frame times, {} per second: {} of them, from 0 to {}. Paths and "
                    "phase portraits have up to eight points per frame.",
                    fps.text(), motion.rows, time_text(motion.end_s)));
    if (motion.failure) {
        chapter.paragraphs.push_back(
            fmt::format("The motion ends early: {}. The figures show the motion before that.",
                        printable(motion.failure->what())));
        chapter.summary += fmt::format(" It diverges after {}; the figures show the motion before that.",
                                       time_text(motion.end_s));
    }
    if (const auto branched_s = film.diagnostics().branched_s) {
        chapter.paragraphs.push_back(
            fmt::format("Before {} bars of a net lay in line, from where several motions were possible; the "
                        "figures show one of them.",
                        time_text(*branched_s)));
    }
    chapter.tables.push_back(largest_table(film, motion));
    add_pictures(film, times, write, chapter);
    return chapter;
}

report::Chapter path_chapter(const Film& film, const MotionSummary& motion) {
    report::Chapter chapter{.title = "Path"};
    if (motion.bodies.empty()) {
        chapter.paragraphs.emplace_back("All particles are pinned: nothing moves.");
        return chapter;
    }
    const System& system = film.system();
    const Extreme& speed = motion.speed;
    if (speed.is_known) {
        chapter.summary = fmt::format("The largest speed is {} at {} (particle {} of {}).",
                                      quantity_text(speed.size, "m/s"), time_text(speed.time_s), speed.index,
                                      body_name(system, speed.body));
    }
    std::vector<Curve> curves = curves_of(film.scene(), system, motion, &BodyCurves::path);
    // Axes far from 0 would have the same number at each tick.
    constexpr double kFar = 1e3;
    const Vec2 origin_m = system.origin_m;
    const double extent_m = std::max(range_of(curves, &view::CurvePoint::x).extent(),
                                     range_of(curves, &view::CurvePoint::y).extent());
    const bool is_far = std::max(std::abs(origin_m.x), std::abs(origin_m.y)) > kFar * extent_m;
    for (Curve& curve : curves) {
        for (view::CurvePoint& point : curve.points) {
            if (is_far) break;
            point.x += origin_m.x;
            point.y += origin_m.y;
        }
    }
    report::Plot plot = make_plot("path", "Path of the tip", {"x", "m"}, {"y", "m"}, curves);
    plot.has_equal_scales = true;
    plot.caption = fmt::format("Path of {}.{}{}", pipeline::particles_text(system, followed_of(motion)),
                               is_far ? fmt::format(" Counted from ({}, {}) m.", origin_m.x, origin_m.y) : "",
                               left_out_text(system, motion));
    add_plot(std::move(plot), kTipData, chapter);
    return chapter;
}

report::Chapter angle_chapter(const Film& film, const MotionSummary& motion) {
    report::Chapter chapter{.title = "Angle"};
    const System& system = film.system();
    const std::ptrdiff_t turning = turning_count(system, motion);
    if (turning == 0) return chapter;
    if (turning < std::ssize(motion.bodies)) {
        chapter.summary = fmt::format(
            "There is no figure of the angle: the free ends of {} of the {} bodies do not "
            "turn about one pin, or come near to it.",
            std::ssize(motion.bodies) - turning, motion.bodies.size());
        return chapter;
    }
    std::vector<Curve> curves = curves_of(film.scene(), system, motion, &BodyCurves::turning);
    for (Curve& curve : curves)
        for (view::CurvePoint& point : curve.points)
            point = {point.time_s, point.time_s, point.x * 180.0 / std::numbers::pi};
    chapter.summary = period_text(film.scene(), motion);
    report::Plot plot = make_plot("angle", "Angle over time", {"t", "s"}, {"angle", "°"}, curves);
    plot.caption =
        fmt::format("Angle of the line from the pin to {}, from straight down, positive towards +x.{}",
                    pipeline::particles_text(system, followed_of(motion)), left_out_text(system, motion));
    add_plot(std::move(plot), kTipData, chapter);
    return chapter;
}

report::Chapter phase_chapter(const Film& film, const MotionSummary& motion) {
    report::Chapter chapter{.title = "Phase portrait"};
    if (motion.bodies.empty()) return chapter;
    const System& system = film.system();
    const bool turns = turning_count(system, motion) == std::ssize(motion.bodies);
    const auto curve = turns ? &BodyCurves::turning : &BodyCurves::phase;
    const std::vector<Curve> curves = curves_of(film.scene(), system, motion, curve);
    report::Plot plot =
        turns ? make_plot("phase", "Phase portrait", {"angle", "rad"}, {"angular velocity", "rad/s"}, curves)
              : make_plot("phase", "Phase portrait", {"x", "m"}, {"vx", "m/s"}, curves);
    plot.caption = turns ? fmt::format(
                               "Phase portrait: the angle of the line from the pin to {}, from straight "
                               "down, positive towards +x, turns counted on, and its rate of change.",
                               pipeline::particles_text(system, followed_of(motion)))
                         : fmt::format(
                               "Phase portrait: the horizontal position of {}, counted from the pin of "
                               "its body or, if that has none or several, from the start, and the "
                               "horizontal velocity.",
                               pipeline::particles_text(system, followed_of(motion)));
    plot.caption += left_out_text(system, motion);
    add_plot(std::move(plot), kTipData, chapter);
    return chapter;
}

report::Chapter energy_chapter(const Film& film, const MotionSummary& motion) {
    report::Chapter chapter{.title = "Energy"};
    const auto error = film.diagnostics().largest.energy_error;
    chapter.summary = error ? fmt::format(
                                  "The energy error, | E - E(0) | over the sum of weight times length of all "
                                  "bodies, or over E(0) without a force, is at most {}.",
                                  quantity_text(*error, ""))
                            : "Damping takes energy on purpose, so there is no energy error to tell.";
    std::vector<Curve> curves{{"kinetic", motion.kinetic}, {"weight", motion.weight}};
    if (motion.is_elastic) curves.push_back({"elastic", motion.elastic});
    curves.push_back({"total", motion.total, "#000000"});
    report::Plot plot = make_plot("energy", "Energy over time", {"t", "s"}, {"energy", "J"}, curves);
    plot.caption = fmt::format(
        "Energy of all free particles over time: kinetic, that of the weight since the "
        "start{}, and their sum.",
        motion.is_elastic ? ", elastic" : "");
    add_plot(std::move(plot), "energy.csv", chapter);
    return chapter;
}

report::Chapter tension_chapter(const Film& film, const MotionSummary& motion) {
    report::Chapter chapter{.title = "Tension"};
    if (!motion.unknown_tensions.empty()) chapter.paragraphs.push_back(unknown_text(film, motion));
    const Extreme& largest = motion.tension;
    if (!largest.is_known) {
        if (!chapter.paragraphs.empty()) chapter.summary = chapter.paragraphs.front();
        return chapter;
    }
    const System& system = film.system();
    chapter.summary = fmt::format("The largest tension is {} at {} ({}).", quantity_text(largest.size, "N"),
                                  time_text(largest.time_s), link_text(system, largest));
    std::vector<Curve> curves = curves_of(film.scene(), system, motion, &BodyCurves::tension);
    std::erase_if(curves, [](const Curve& curve) {
        return std::ranges::all_of(curve.points,
                                   [](const view::CurvePoint& point) { return std::isnan(point.y); });
    });
    if (!curves.empty()) {
        report::Plot plot =
            make_plot("tension", "Largest tension over time", {"t", "s"}, {"largest tension", "N"}, curves);
        plot.caption = fmt::format(
            "Largest tension of a link{} over time; one that pushes counts by the size "
            "of its force.{}",
            curves.size() > 1 ? " of each body" : "", left_out_text(system, motion));
        add_plot(std::move(plot), "tension.csv", chapter);
    }
    add_tensions_along(film, motion, chapter);
    return chapter;
}

report::Chapter strain_chapter(const Film& film, const MotionSummary& motion) {
    report::Chapter chapter{.title = "Strain"};
    const System& system = film.system();
    const Extreme& largest = motion.strain;
    const bool stretches = std::ranges::any_of(
        system.bodies, [](const Body& body) { return body.material.compliance_1_n > 0.0; });
    if (largest.is_known) {
        chapter.summary = fmt::format(
            "The largest strain, | length / rest length - 1 |, is {} at {} ({}){}.",
            quantity_text(largest.size, ""), time_text(largest.time_s), link_text(system, largest),
            stretches ? "" : ": an error of the method, because these links do not stretch");
    }
    constexpr double kRounding = 1e-13;
    if (largest.is_known && largest.size < kRounding) {
        chapter.summary =
            fmt::format("The links keep their lengths: the largest strain is {}, which is rounding.",
                        quantity_text(largest.size, ""));
        return chapter;
    }
    const std::vector<Curve> curves = curves_of(film.scene(), system, motion, &BodyCurves::strain);
    if (curves.empty()) return chapter;
    report::Plot plot =
        make_plot("strain", "Largest strain over time", {"t", "s"}, {"largest strain", ""}, curves);
    plot.caption =
        fmt::format("Largest strain of a link{} over time; a slack link of a string counts as 0.{}",
                    curves.size() > 1 ? " of each body" : "", left_out_text(system, motion));
    add_plot(std::move(plot), "strain.csv", chapter);
    return chapter;
}

}  // namespace corda::figures
