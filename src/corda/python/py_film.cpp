// The class `Film` of the Python module's C++ half, which corda/_film.py wraps.
#include "py_film.hpp"

#include <pybind11/stl.h>

#include <corda/film/plan_text.hpp>

#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "figures.hpp"

namespace corda::python {
namespace {

py::array_t<double> label(const PyFilm& film, const char* name) {
    const Label* const label = find_label(name);
    const auto read = [&](const Film& shown) {
        return read_labels(shown, std::span(&label, 1), shown.frame_count());
    };
    auto arrays = film.with_film(read);
    return to_numpy<double>(std::move(arrays.front()));
}

py::array_t<double> times(const PyFilm& film) {
    const Film& shown = film.film();
    std::vector<double> all;
    for (std::int64_t k = 0; k < shown.frame_count(); ++k) all.push_back(shown.time_s(k));
    return py::array_t<double>(static_cast<py::ssize_t>(all.size()), all.data());
}

py::array_t<std::uint8_t> mask(const PyFilm& film, std::int64_t k) {
    const std::vector<std::uint8_t> pixels = film.with_film([k](const Film& shown) { return shown.mask(k); });
    const VideoDef& video = film.film().scene().video;
    return py::array_t<std::uint8_t>({video.height_px, video.width_px}, pixels.data());
}

using Points = py::array_t<double, py::array::c_style | py::array::forcecast>;

py::array_t<double> to_pixels(const PyFilm& film, const Points& points_m) {
    if (points_m.ndim() < 1 || points_m.shape(points_m.ndim() - 1) != 2)
        throw py::value_error("points are an array of shape (..., 2)");
    const std::vector<py::ssize_t> shape(points_m.shape(), points_m.shape() + points_m.ndim());
    std::vector<Vec2> points;
    for (const double* at = points_m.data(); at != points_m.data() + points_m.size(); at += 2)
        points.push_back({at[0], at[1]});
    const bool moves = film.film().scene().camera.moves();
    const std::int64_t frames = film.film().frame_count();
    if (moves && (points_m.ndim() != 3 || points_m.shape(0) != frames))
        throw py::value_error(
            "the camera moves: points are an array of shape (frames, ..., 2) of all frames");
    const std::size_t per_frame = moves ? points.size() / static_cast<std::size_t>(frames) : points.size();
    const std::vector<Vec2> pixels = film.with_film([&](const Film& shown) {
        std::vector<Vec2> all;
        for (std::int64_t k = 0; all.size() < points.size(); ++k) {
            const auto some = std::span(points).subspan(all.size(), per_frame);
            const std::vector<Vec2> mapped = shown.to_pixels(some, shown.time_s(k));
            all.insert(all.end(), mapped.begin(), mapped.end());
        }
        return all;
    });
    py::array_t<double> all(shape);
    double* to = all.mutable_data();
    for (const Vec2 pixel : pixels) {
        *to++ = pixel.x;
        *to++ = pixel.y;
    }
    return all;
}

py::dict plan(const PyFilm& film) {
    return film.with_film([](const Film& shown) {
        const Plan& chosen = shown.plan();
        const auto estimate_px = shown.error_estimate_px();
        const py::gil_scoped_acquire hold;
        py::list methods;
        for (const BodyPlan& body : chosen.bodies) methods.append(std::string(method_name(body)));
        py::dict all;
        all["methods"] = methods;
        all["error_estimate_m"] = chosen.error_estimate_m;
        all["error_estimate_px"] = estimate_px;
        all["horizon_s"] = chosen.horizon_s;
        all["notes"] = chosen.notes;
        return all;
    });
}

py::dict camera(const PyFilm& film) {
    return film.with_film([](const Film& shown) {
        const CameraDef& def = shown.camera();
        const py::gil_scoped_acquire hold;
        py::dict all;
        all["center"] = py::make_tuple(def.center_m->x, def.center_m->y);
        all["height"] = *def.height_m;
        all["margin"] = def.margin;
        return all;
    });
}

std::int64_t save(const PyFilm& film, const std::string& path, bool force, bool resume,
                  py::object on_progress) {
    Asking asking(std::move(on_progress));
    RenderDef def{.force = force, .resume = resume};
    def.on_progress = [&](std::int64_t done, std::int64_t total) { return asking(done, total); };
    const Rendered rendered =
        film.with_film([&](const Film& shown) { return render_video(shown, path, def); }, asking);
    if (!rendered.complete) {
        throw Error(ExitCode::kInterrupted,
                    rendered.frames == 0 ? "stopped by on_progress; nothing was written"
                                         : "stopped by on_progress; the frames so far are in '" + path + "'");
    }
    return rendered.frames;
}

/// The ending of a video that browsers play, and the film that it is to be made of if `film` does not fit it:
/// with even sides, as render --pad makes them, and the default encoder.
std::pair<std::string, std::unique_ptr<PyFilm>> for_browser(const PyFilm& film, const std::string& backend,
                                                            bool require_gpu) {
    Scene scene = film.film().scene();
    const bool is_opaque = !scene.style.background || scene.style.background->is_opaque();
    const EncoderDef encoder = scene.video.encoder;
    const bool is_default =
        encoder.codec.empty() && encoder.preset.empty() && encoder.pix == PixelChoice::kAuto;
    const bool is_even = scene.video.width_px % 2 == 0 && scene.video.height_px % 2 == 0;
    const char* const ending = is_opaque ? ".mp4" : ".webm";
    if (is_default && is_even) return {ending, nullptr};
    scene.video.width_px += scene.video.width_px % 2;
    scene.video.height_px += scene.video.height_px % 2;
    scene.video.encoder = {};
    scene.video.encoder.threads = encoder.threads;
    scene.video.encoder.jobs = encoder.jobs;
    return {ending, std::make_unique<PyFilm>(scene, backend, require_gpu)};
}

using Numbers = py::array_t<double, py::array::c_style>;
using Given = std::pair<Numbers, Numbers>;

/// The motion of the arrays `times`, (n), and `positions`, (n, particles, 2).
GivenMotion motion_of(const Given& given) {
    const auto& [times, positions] = given;
    std::vector<Vec2> positions_m;
    for (const double* at = positions.data(); at != positions.data() + positions.size(); at += 2)
        positions_m.push_back({at[0], at[1]});
    return {std::vector<double>(times.data(), times.data() + times.size()), std::move(positions_m)};
}

}  // namespace

py::array_t<std::uint8_t> to_numpy(Image image) {
    auto owned = std::make_unique<Image>(std::move(image));
    const std::vector<py::ssize_t> shape{owned->height(), owned->width(), 4};
    std::uint8_t* const data = owned->data();
    const py::capsule owner(owned.release(), [](void* kept) { delete static_cast<Image*>(kept); });
    return py::array_t<std::uint8_t>(shape, data, owner);
}

void add_film(py::module_& module) {
    py::class_<PyFilm> film(module, "Film");
    film.def(py::init([](const std::string& text, const std::string& source, bool is_path,
                         const std::vector<std::string>& settings, const std::string& backend,
                         bool require_gpu, const std::optional<Given>& given) {
            Scene scene = Asking().run(
                [&] { return is_path ? load_scene(source, settings) : parse_scene(text, source, settings); });
            if (given) give_motion(scene, motion_of(*given));
            return std::make_unique<PyFilm>(scene, backend, require_gpu);
        }))
        .def("frame_count", [](const PyFilm& film) { return film.film().frame_count(); })
        .def("size",
             [](const PyFilm& film) {
                 const VideoDef& video = film.film().scene().video;
                 return std::pair(video.width_px, video.height_px);
             })
        .def("fps",
             [](const PyFilm& film) {
                 const Rational fps = film.film().scene().video.fps.rational();
                 return std::pair(fps.num, fps.den);
             })
        .def("frame",
             [](const PyFilm& film, std::int64_t k) {
                 return to_numpy(film.with_film([k](const Film& shown) { return shown.frame(k); }));
             })
        .def("still",
             [](const PyFilm& film, double time_s, double shutter) {
                 return to_numpy(
                     film.with_film([=](const Film& shown) { return shown.still(time_s, shutter); }));
             })
        .def("for_browser", &for_browser)
        .def("positions", [](const PyFilm& film) { return label(film, "positions"); })
        .def("velocities", [](const PyFilm& film) { return label(film, "velocities"); })
        .def("tensions", [](const PyFilm& film) { return label(film, "tensions"); })
        .def("energy", [](const PyFilm& film) { return label(film, "energy"); })
        .def("times", &times)
        .def("mask", &mask)
        .def("to_pixels", &to_pixels)
        .def("plan", &plan)
        .def("camera", &camera)
        .def("save", &save);
    add_figures(module, film);
}

}  // namespace corda::python
