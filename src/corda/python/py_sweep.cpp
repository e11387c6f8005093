// The films of the samples of a sweep, and what its file is checked against: for corda/sweep.py.
#include <corda/film/plan_text.hpp>
#include <corda/film/series.hpp>
#include <corda/film/swing.hpp>
#include <corda/media/format/format.hpp>
#include <corda/scene/document.hpp>
#include <corda/scene/schema.hpp>

#include <pybind11/stl.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <numeric>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "py_film.hpp"

namespace corda::python {
namespace {

/// The files that rendering the film to `name` makes: a video, or a picture per frame.
py::list files(const PyFilm& film, const std::string& name) {
    const auto made = film.with_film([&](const Film& shown) { return video_files(shown, name); });
    py::list all;
    for (const std::string& file : made) all.append(py::bytes(file));
    return all;
}

/// All frames: uint8 (frames, height, width, 4).
py::array_t<std::uint8_t> frames(const PyFilm& film) {
    const VideoDef& video = film.film().scene().video;
    const std::int64_t count = film.film().frame_count();
    py::array_t<std::uint8_t> all(
        {count, std::int64_t{video.height_px}, std::int64_t{video.width_px}, std::int64_t{4}});
    std::uint8_t* to = all.mutable_data();
    film.with_film([&](const Film& shown) {
        for (std::int64_t k = 0; k < count; ++k) {
            check_cancelled();
            const Image image = shown.frame(k);
            to = std::copy_n(image.data(), image.size_bytes(), to);
        }
        return true;
    });
    return all;
}

/// A scene with settings, which messages name with "vary". Its video has the frames of its arrays alone.
Scene sample_scene(const std::string& text, const std::string& source,
                   const std::vector<std::string>& settings) {
    Scene scene = Asking().run([&] { return parse_scene(text, source, {}, {"vary", settings}); });
    scene.video.hold_s = 0.0;
    return scene;
}

/// The film of a scene with settings.
std::unique_ptr<PyFilm> sample_film(const std::string& text, const std::string& source,
                                    const std::vector<std::string>& settings, const std::string& backend,
                                    bool require_gpu) {
    return std::make_unique<PyFilm>(sample_scene(text, source, settings), backend, require_gpu);
}

/// Arrays of all frames by the names of labels.
py::dict labels(const PyFilm& film, const std::vector<std::string>& names) {
    std::vector<const Label*> labels;
    for (const std::string& name : names) labels.push_back(find_label(name));
    auto read =
        film.with_film([&](const Film& shown) { return read_labels(shown, labels, shown.frame_count()); });
    py::dict arrays;
    for (Array& array : read) {
        const py::str name(array.name);
        if (array.is_bytes)
            arrays[name] = to_numpy<std::uint8_t>(std::move(array));
        else
            arrays[name] = to_numpy<double>(std::move(array));
    }
    return arrays;
}

/// Facts of a whole motion: its method, its largest strain and energy error, and the particle whose swing
/// about `pin` is measured.
py::dict sample_facts(const PyFilm& film) {
    const Film& shown = film.film();
    static_cast<void>(shown.state(shown.last_frame()));  // a motion that diverges has no facts
    const Figures& largest = shown.diagnostics().largest;
    const auto tracked = film::tracked_particles(shown.system());
    py::dict facts;
    facts["method"] = method_names(film.film().plan());
    facts["strain_max"] = largest.strain;
    facts["energy_error"] = largest.energy_error;
    facts["particle"] = tracked.empty() ? py::object(py::none()) : py::cast(tracked.front().particle);
    facts["pin"] = tracked.empty() ? py::object(py::none()) : py::cast(tracked.front().pin);
    return facts;
}

/// The times in s at which something passes below its pin, its period in s or None, and why it has none.
/// `arm` and `velocity`: (times, 2), relative to the pin.
py::tuple swing(const std::vector<double>& times_s, const py::array_t<double>& arm,
                const py::array_t<double>& velocity) {
    const auto arm_m = arm.unchecked<2>();
    const auto velocity_m_s = velocity.unchecked<2>();
    film::Passages passages;
    for (py::ssize_t i = 0; i < std::ssize(times_s); ++i)
        passages.include(times_s[static_cast<std::size_t>(i)], {arm_m(i, 0), arm_m(i, 1)},
                         {velocity_m_s(i, 0), velocity_m_s(i, 1)});
    const film::Period period = passages.period();
    return py::make_tuple(passages.times_s(), period.seconds, period.reason);
}

/// Units of the keys of a section of scenes, by name.
py::dict scene_keys(const std::string& section) {
    py::dict units;
    for (const scene::Key& key : scene::keys_of(section))
        units[py::str(std::string(key.name))] = std::string(key.unit);
    return units;
}

/// Why a dotted key does not fit a scene, with a remedy; empty if it does.
py::str misfit(const std::string& text, const std::string& source, const std::string& key) {
    toml::table document = scene::parse_document(text, source);
    return text_of(scene::misfit_of(document, key).c_str());
}

/// The poses at some times in one picture: uint8 (height, width, 4).
py::array_t<std::uint8_t> poses(const PyFilm& film, const std::vector<double>& times_s) {
    const Image image =
        film.with_film([&](const Film& shown) { return draw_figure(shown, {.times_s = times_s}); });
    return py::array_t<std::uint8_t>({image.height(), image.width(), 4}, image.data());
}

/// The model of a scene whose period theory knows, from the scene alone: "point", "rod" or "rope", the number
/// and the length in m of equal links, and the acceleration in m/s2; None for others. See period_of() in
/// corda/_theory.py.
py::object swing_of(const std::string& text, const std::string& source,
                    const std::vector<std::string>& settings) {
    const Scene scene = sample_scene(text, source, settings);
    if (scene.ropes.size() != 1 || !scene.nets.empty()) return py::none();
    const RopeDef& rope = scene.ropes.front();
    Vec2 gravity = scene.world.gravity_m_s2;
    const auto* const relaxation = std::get_if<RelaxationDef>(&scene.solver);
    if (relaxation != nullptr && relaxation->force_n)
        gravity = {relaxation->force_n->x / rope.mass_kg.front(),
                   relaxation->force_n->y / rope.mass_kg.front()};
    const bool is_plain = !rope.closed && rope.rest_m.empty() && rope.bending_n_m2 == 0.0 &&
                          rope.material.compliance_1_n == 0.0 &&
                          rope.pinned == std::vector<std::uint32_t>{0} && scene.world.drag_1_s == 0.0 &&
                          gravity.x == 0.0 && gravity.y < 0.0;
    const auto distance_m = [&](std::size_t a, std::size_t b) {
        return std::hypot(rope.points_m[b].x - rope.points_m[a].x, rope.points_m[b].y - rope.points_m[a].y);
    };
    const std::size_t links = rope.points_m.size() - 1;
    const double link_m = distance_m(0, 1);
    for (std::size_t i = 1; i < links; ++i)
        if (std::abs(distance_m(i, i + 1) - link_m) > 1e-9 * link_m) return py::none();
    if (!is_plain) return py::none();
    const double length_m = static_cast<double>(links) * link_m;
    const bool is_straight = std::abs(distance_m(0, links) - length_m) <= 1e-9 * length_m;
    const double own_kg = std::accumulate(rope.mass_kg.begin(), rope.mass_kg.end(), 0.0);
    if (links == 1 || (is_straight && own_kg <= 0.01 * rope.payload_kg))
        return py::make_tuple("point", 1, length_m, -gravity.y);
    const bool has_equal_masses =
        rope.payload_kg == 0.0 &&
        std::ranges::count(rope.mass_kg, rope.mass_kg.front()) == std::ssize(rope.mass_kg);
    if (!has_equal_masses) return py::none();
    return py::make_tuple(rope.reach > 1 ? "rod" : "rope", links, link_m, -gravity.y);
}

}  // namespace

void add_sweep(py::module_& module) {
    module.def("files", &files);
    module.def("frames", &frames);
    module.def("sample_film", &sample_film);
    module.def("sample_facts", &sample_facts);
    module.def("swing", &swing);
    module.def("labels", &labels);
    module.def("poses", &poses);
    module.def("swing_of", &swing_of);
    module.def("scene_keys", &scene_keys);
    module.def("misfit", &misfit);
    module.def("check_scene", [](const std::string& text, const std::string& source) {
        Asking().run([&] { static_cast<void>(parse_scene(text, source)); });
    });
    module.def("picture_size", [](const std::string& text, const std::string& source,
                                  const std::vector<std::string>& settings) {
        const Scene scene = sample_scene(text, source, settings);
        return std::pair(scene.video.width_px, scene.video.height_px);
    });
    // The encoder of an output, with the versions on which its bytes depend.
    module.def("encoder_of",
               [](const std::string& text, const std::string& source, const std::string& output) {
                   return Asking().run([&] {
                       return media::find_format(output, parse_scene(text, source).video).library_versions();
                   });
               });
}

}  // namespace corda::python
