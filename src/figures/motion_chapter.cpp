#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "corda/core/text.hpp"
#include "corda/figures/chapters.hpp"
#include "corda/figures/quantity_text.hpp"
#include "corda/pipeline/plan_text.hpp"

namespace corda::figures {
namespace {

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
    if (const auto bound = bound_text(film)) {
        text +=
            fmt::format("The error of the displayed positions is at most {}{}.", *bound,
                        plan.horizon_s ? "; after that the motion cannot be predicted, and what is shown is "
                                         "one possible motion"
                                       : ", shown by tighter runs");
    } else if (plan.horizon_s) {
        text += "The motion cannot be predicted: what is shown is one possible motion.";
    } else {
        text += "There is no bound of its error.";
    }
    return text;
}

std::string place_of(const Film& film, const Extreme& extreme, const char* what) {
    return fmt::format("{} {} of {}", what, extreme.index, body_name(film.system(), extreme.body));
}

report::Table largest_table(const Film& film, const MotionSummary& reading) {
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
    add("speed", "m/s", reading.speed, "particle");
    add("tension", "N", reading.tension, "link");
    add("strain", "", reading.strain, "link");
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

void add_pictures(const Film& film, const FigureTimes& moments, const WritePoses& write,
                  report::Chapter& chapter) {
    const std::string name = printable(film.scene().name);
    if (moments.strobe_s.size() > 1) {
        const std::vector<double> times_s = moments.strobe_s;
        const std::string poses = fmt::format("poses at t = {}", times_text(times_s));
        chapter.pictures.push_back(
            {"strobe", fmt::format("{}, {}", name, poses),
             fmt::format("Strobe: {}, the fainter the earlier{}.", poses,
                         moments.is_swing ? "; the last is where the first swing ends" : ""),
             [write, times_s](const std::string& path, double width_mm) { write(path, width_mm, times_s); }});
    }
    std::size_t number = 1;
    for (const double time_s : moments.stills_s) {
        const std::string at = "at t = " + time_text(time_s);
        chapter.pictures.push_back(
            {fmt::format("still_{}", number++), fmt::format("{} {}", name, at),
             fmt::format("The scene {}.", at),
             [write, time_s](const std::string& path, double width_mm) { write(path, width_mm, {time_s}); },
             moments.stills_s.size() > 1});
    }
}

}  // namespace

report::Chapter motion_chapter(Film& film, const MotionSummary& reading, const FigureTimes& moments,
                               const WritePoses& write) {
    report::Chapter chapter;
    chapter.title = "Motion";
    chapter.summary = model_text(film) + " " + method_text(film);
    const Rational fps = film.scene().video.fps.rational();
    chapter.paragraphs.push_back(
        fmt::format("All figures are at frame times, {} per second: {} of them, from 0 to {}.", fps.text(),
                    reading.rows, time_text(reading.end_s)));
    if (reading.failure) {
        chapter.paragraphs.push_back(
            fmt::format("The motion ends early: {}. The figures are of what comes before.",
                        printable(reading.failure->what())));
        chapter.summary +=
            fmt::format(" It diverges after {}; this is what comes before.", time_text(reading.end_s));
    }
    if (const auto branched_s = film.diagnostics().branched_s) {
        chapter.paragraphs.push_back(
            fmt::format("Before {} bars of a net lay in line, from where the motion could go on in several "
                        "ways; what is shown after it is one of them.",
                        time_text(*branched_s)));
    }
    chapter.tables.push_back(largest_table(film, reading));
    add_pictures(film, moments, write, chapter);
    return chapter;
}

}  // namespace corda::figures
