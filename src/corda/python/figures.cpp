// What corda.plot and corda.report need of a film besides its public arrays, and drawings in print.
#include "figures.hpp"

#include <corda/core/cancel.hpp>
#include <corda/core/direction.hpp>
#include <corda/core/markup.hpp>
#include <corda/core/text.hpp>
#include <corda/film/film.hpp>
#include <corda/film/motion.hpp>
#include <corda/film/plan_text.hpp>
#include <corda/film/print.hpp>
#include <corda/film/series.hpp>
#include <corda/sim/recording.hpp>
#include <corda/sim/solver.hpp>
#include <corda/view/colors.hpp>
#include <corda/view/scene_view.hpp>
#include <corda/view/words.hpp>

#include <pybind11/stl.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace corda::python {
namespace {

/// Whether lines of a colour can be seen on white: a contrast of 2 or more, as WCAG 2.1 defines it, without
/// its gamma of sRGB's foot.
bool shows_on_white(const Color& color) {
    constexpr double kContrast = 2.0;
    constexpr double kGlare = 0.05;
    const auto linear = [&](int channel) {
        constexpr double kGamma = 2.2;
        return std::pow((channel * color.a + 255.0 * (255 - color.a)) / (255.0 * 255.0), kGamma);
    };
    const double luminance = 0.2126 * linear(color.r) + 0.7152 * linear(color.g) + 0.0722 * linear(color.b);
    return (1.0 + kGlare) / (luminance + kGlare) >= kContrast;
}

/// The style of a scene in print: the paper theme if it names none, unless its own ground is dark, or one of
/// its own colours of ropes and nets does not show on white.
StyleDef style_in_print(const Scene& scene) {
    StyleDef style = scene.style;
    const auto& ground = style.background;
    const auto all_show = [](const std::vector<Color>& colors) {
        return std::ranges::all_of(colors, shows_on_white);
    };
    const bool is_dark = ground && (shows_on_white(ground->top) || shows_on_white(ground->bottom));
    const bool show =
        all_show(style.palette) && std::ranges::all_of(scene.body_styles, [&](const auto& body) {
            return (!body.color || shows_on_white(*body.color)) && all_show(body.link_colors);
        });
    if (!style.theme && !is_dark && show) style.theme = Theme::kPaper;
    return style;
}

/// The colour of each body in print as "#rrggbb"; empty if it does not show on white, or colours tell
/// something else than bodies.
std::vector<std::string> curve_colors(const Scene& scene, const System& system) {
    const StyleDef style = style_in_print(scene);
    const view::SceneView drawn = view::make_scene_view(system, {}, style, scene.body_styles,
                                                        scene.video.width_px, scene.video.height_px, {});
    std::vector<std::string> texts;
    for (Color color : view::body_colors(drawn)) {
        color.a = 255;
        const bool is_usable = style.color_by == ColorBy::kBody && shows_on_white(color);
        texts.push_back(is_usable ? color.text() : "");
    }
    return texts;
}

/// The look of a scene in a report: its shape, a width in millimetres at kPrintPpi, letters of that size and
/// no live plot. What the scene says in pixels keeps its share of the width.
Scene look_in_report(const Scene& scene, double width_mm, double letter_pt) {
    // Limits of height over width, so that a picture fits a page.
    constexpr double kFlattest = 0.2;
    constexpr double kTallest = 1.4;
    Scene look = scene;
    look.style = style_in_print(scene);
    VideoDef& video = look.video;
    const double shape = std::clamp(1.0 * video.height_px / video.width_px, kFlattest, kTallest);
    const double factor = film::kPrintPpi * width_mm / kMmPerInch / video.width_px;
    video.width_px = static_cast<int>(std::lround(video.width_px * factor));
    video.height_px = static_cast<int>(std::lround(shape * video.width_px));
    scale_px(look, factor);
    look.overlay.plots.clear();
    look.overlay.plot_range = {};
    if (!look.overlay.energy) look.overlay.energy_zero = EnergyZero::kStart;
    look.overlay.text_px = film::letter_px(letter_pt, film::kPrintPpi);
    return look;
}

/// A row of numbers per frame, up to the frame at which the motion diverges.
struct Rows {
    std::vector<double> times_s;
    std::vector<double> positions_m;  ///< pairs per particle, relative to the system's origin
    std::vector<double> velocities_m_s;
    std::vector<double> tensions_n;  ///< per link, body by body
    std::vector<double> strains;     ///< the same
    std::vector<double> energies_j;  ///< kinetic, of the weight, elastic
    std::vector<double> energy_errors;
    std::optional<std::string> failure;
    Diagnostics diagnostics;
};

void append_pairs(const std::vector<double>& x, const std::vector<double>& y, std::vector<double>& pairs) {
    for (std::size_t i = 0; i < x.size(); ++i) pairs.insert(pairs.end(), {x[i], y[i]});
}

void add_row(const film::Instant& instant, Rows& rows) {
    const State& state = instant.state;
    const System& system = instant.source.motion.system;
    rows.times_s.push_back(state.time_s);
    append_pairs(state.x_m, state.y_m, rows.positions_m);
    append_pairs(state.vx_m_s, state.vy_m_s, rows.velocities_m_s);
    for (const Body& body : system.bodies) {
        for (std::size_t i = body.first_bar; i < body.first_bar + body.link_count; ++i) {
            rows.tensions_n.push_back(sim::kind_of(Quantity::kTension).value(system, body, i, state));
            rows.strains.push_back(sim::kind_of(Quantity::kStrain).value(system, body, i, state));
        }
    }
    for (const film::Series& one : {film::kSeries.kinetic, film::kSeries.weight, film::kSeries.elastic})
        rows.energies_j.push_back(one.value(instant));
    rows.energy_errors.push_back(film::kSeries.energy_error.value(instant));
}

Rows read_rows(const Film& film) {
    const film::SeriesSource source(film.motion());
    Rows rows;
    try {
        for (std::int64_t k = 0; k <= film.last_frame(); ++k) {
            check_cancelled();
            const double time_s = film.time_s(k);
            film.motion().for_each({&time_s, 1}, [&](const State& state, const Figures& figures) {
                add_row({source, state, figures}, rows);
            });
        }
    } catch (const Error& error) {
        if (error.code() != ExitCode::kDiverged || rows.times_s.empty()) throw;
        rows.failure = error.what();
    }
    rows.diagnostics = film.diagnostics();
    return rows;
}

py::array_t<double> to_array(const std::vector<double>& numbers, std::size_t frames, py::ssize_t pairs = 1) {
    const auto rows = static_cast<py::ssize_t>(frames);
    const py::ssize_t columns = static_cast<py::ssize_t>(numbers.size()) / rows / pairs;
    if (pairs == 1) return py::array_t<double>({rows, columns}, numbers.data());
    return py::array_t<double>({rows, columns, pairs}, numbers.data());
}

py::dict rows(const PyFilm& film) {
    const Rows read = film.with_film(read_rows);
    const std::size_t frames = read.times_s.size();
    py::dict all;
    all["times"] = py::array_t<double>(static_cast<py::ssize_t>(frames), read.times_s.data());
    all["positions"] = to_array(read.positions_m, frames, 2);
    all["velocities"] = to_array(read.velocities_m_s, frames, 2);
    all["tensions"] = to_array(read.tensions_n, frames);
    all["strains"] = to_array(read.strains, frames);
    all["energies"] = to_array(read.energies_j, frames);
    all["energy_errors"] = py::array_t<double>(static_cast<py::ssize_t>(frames), read.energy_errors.data());
    all["failure"] = read.failure ? py::object(text_of(read.failure->c_str())) : py::none();
    const Figures& largest = read.diagnostics.largest;
    all["energy_error"] = largest.energy_error;
    all["pin_force_n"] = largest.loads ? std::optional(largest.loads->pin_force_n) : std::nullopt;
    all["branched_s"] = read.diagnostics.branched_s;
    return all;
}

py::dict body_facts(const Film& film, const System& named, std::size_t b,
                    const std::vector<film::TrackedParticle>& tracked) {
    const System& system = film.system();
    const Body& body = system.bodies[b];
    py::dict facts;
    facts["name"] = text_of(printable(body_name(named, b)).c_str());
    facts["shown_name"] =
        text_of(printable(view::translated_name(named, b, film.scene().overlay.language)).c_str());
    facts["is_net"] = body.is_net;
    facts["is_chain"] = body.is_chain;
    facts["particles"] = py::make_tuple(body.first_particle, body.first_particle + body.particle_count);
    std::vector<double> rest_m;
    std::vector<std::uint32_t> ends;
    for (std::size_t i = body.first_bar; i < body.first_bar + body.link_count; ++i) {
        rest_m.push_back(system.bars[i].rest_m);
        ends.insert(ends.end(), {system.bars[i].a, system.bars[i].b});
    }
    const auto links = static_cast<py::ssize_t>(body.link_count);
    facts["rest_m"] = py::array_t<double>(links, rest_m.data());
    facts["ends"] = py::array_t<std::uint32_t>({links, py::ssize_t{2}}, ends.data());
    std::uint32_t reach = 1;
    for (std::size_t i = body.first_bar; i < body.first_bar + body.bar_count; ++i)
        reach = std::max(reach, system.bars[i].reach);
    facts["reach"] = reach;
    facts["compliance"] = body.material.compliance_1_n;
    facts["payload_kg"] = body.payload_kg;
    const BodyPlan& plan = film.plan().bodies[b];
    facts["method"] = std::string(method_name(plan));
    facts["knows_tensions"] = plan.reason != PlanReason::kGiven && sim::knows_tensions(plan.method);
    facts["moves"] = false;
    for (std::size_t i = body.first_particle; i < body.first_particle + body.particle_count; ++i)
        if (!system.stays_pinned(i)) facts["moves"] = true;
    for (const film::TrackedParticle& one : tracked) {
        if (one.body != b) continue;
        facts["tracked"] = one.particle;
        facts["is_free_end"] = one.is_free_end;
        facts["pin"] = one.pin;
    }
    return facts;
}

/// The plan in words.
py::dict plan_facts(const Film& film, const std::optional<std::string>& estimate) {
    const Plan& plan = film.plan();
    const std::vector<MethodGroup> groups = groups_of(plan);
    py::dict facts;
    facts["system"] = system_text(film.system());
    facts["modelled"] = modelled_terms(film.scene(), plan);
    facts["method"] = method_names(plan);
    facts["solver"] = text_of(plan_text(film.system(), plan).c_str());
    facts["reason"] = groups.size() == 1
                          ? py::object(py::str(reason_text(plan.bodies[groups.front().bodies.front()])))
                          : py::none();
    facts["estimate"] = estimate ? py::object(text_of(estimate->c_str())) : py::none();
    facts["bars"] = film.system().bars.size();
    return facts;
}

py::dict facts(const PyFilm& film) {
    const Film& shown = film.film();
    const Scene& scene = shown.scene();
    const System& system = shown.system();
    const System named = named_in_files(scene, system);
    const std::vector<std::string> keys = body_keys(named);
    const std::vector<std::string> colors = curve_colors(scene, system);
    const auto tracked = film::tracked_particles(system);
    py::dict all = plan_facts(shown, error_estimate_text(shown));
    py::list bodies;
    for (std::size_t b = 0; b < system.bodies.size(); ++b) {
        py::dict body = body_facts(shown, named, b, tracked);
        body["key"] = text_of(keys[b].c_str());
        body["color"] = colors[b];
        bodies.append(std::move(body));
    }
    all["bodies"] = bodies;
    all["mass_kg"] =
        py::array_t<double>(static_cast<py::ssize_t>(system.mass_kg.size()), system.mass_kg.data());
    py::array_t<bool> pinned(static_cast<py::ssize_t>(system.particle_count()));
    for (std::size_t i = 0; i < system.particle_count(); ++i) pinned.mutable_data()[i] = system.is_pinned(i);
    all["pinned"] = pinned;
    all["bends"] = !system.bends.empty();
    all["origin"] = py::make_tuple(system.origin_m.x, system.origin_m.y);
    all["gravity"] = py::make_tuple(scene.world.gravity_m_s2.x, scene.world.gravity_m_s2.y);
    const auto* const relaxation = std::get_if<RelaxationDef>(&scene.solver);
    all["force"] = relaxation != nullptr && relaxation->force_n
                       ? py::object(py::make_tuple(relaxation->force_n->x, relaxation->force_n->y))
                       : py::none();
    all["drag"] = scene.world.drag_1_s;
    all["has_wind"] = scene.world.wind_m_s != Vec2{} || scene.world.gusts != WaveDef{};
    all["has_moves"] = !system.moves.empty();
    all["has_events"] = system.has_events();
    all["duration"] = scene.world.duration_s;
    all["rate"] = scene.video.scene_rate().rational().text();
    all["name"] = text_of(printable(scene.name).c_str());
    all["title"] = text_of(printable(scene.overlay.title).c_str());
    all["language"] = static_cast<int>(scene.overlay.language);
    const Ground ground = view::theme_colors(style_in_print(scene)).ground;
    all["is_on_white"] = !shows_on_white(ground.top) && !shows_on_white(ground.bottom);
    all["simulation_passes"] = shown.plan().simulation_passes;
    return all;
}

/// Writes the poses at some increasing times in one picture; the extension of `path` chooses the format.
/// `look`: the scene of the film in another size.
void write_poses(const Film& film, const Scene& look, double pixels_per_inch, const std::string& path,
                 const std::vector<double>& times_s, bool force) {
    PngInfo info;
    info.text = {{"Title", printable(look.name)}, {"Time", fmt::format("{} s", fmt::join(times_s, ", "))}};
    info.pixels_per_inch = pixels_per_inch;
    write_figure(path, film.with_look(look), {.times_s = times_s}, info, {.force = force});
}

void save_still(const PyFilm& film, const std::string& path, const std::vector<double>& times_s,
                std::optional<double> width_mm, std::optional<double> pixels_per_inch,
                std::optional<double> letter_pt, bool force) {
    film.with_film([&](const Film& shown) {
        const film::Print print = film::print_of(shown.scene(), {width_mm, pixels_per_inch, letter_pt},
                                                 {"width_mm", "ppi", "font_pt"});
        Scene look = shown.scene();
        look.video.width_px = print.width_px;
        look.video.height_px = print.height_px;
        look.overlay.text_px = print.text_px;
        write_poses(shown, look, print.pixels_per_inch, path, times_s, force);
        return 0;
    });
}

void save_report_still(const PyFilm& film, const std::string& path, const std::vector<double>& times_s,
                       double width_mm, double letter_pt, bool force) {
    film.with_film([&](const Film& shown) {
        const Scene look = look_in_report(shown.scene(), width_mm, letter_pt);
        write_poses(shown, look, look.video.width_px * kMmPerInch / width_mm, path, times_s, force);
        return 0;
    });
}

}  // namespace

void add_figures(py::module_& module, py::class_<PyFilm>& film) {
    film.def("facts", &facts)
        .def("rows", &rows)
        .def("save_still", &save_still)
        .def("save_report_still", &save_report_still);
    module.attr("page_style") = kPageStyle;
    // With the same bits on every machine, unlike numpy.arctan2.
    module.def("angle", py::vectorize([](double y, double x) { return angle_rad(y, x); }));
    module.def("translated", [](const std::string& english, int language) {
        return view::translated(english, static_cast<Language>(language));
    });
}

}  // namespace corda::python
