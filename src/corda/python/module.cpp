// The C++ half of the Python module `corda`: what corda/__init__.py wraps.
#include <pybind11/functional.h>
#include <pybind11/stl.h>

#include <corda/core/machine.hpp>
#include <corda/film/plan_text.hpp>
#include <corda/golden/check_golden.hpp>
#include <corda/golden/compare.hpp>

#include <array>
#include <cstring>
#include <optional>
#include <tuple>
#include <vector>

#include "figures.hpp"
#include "py_film.hpp"

namespace {

namespace py = pybind11;
using corda::python::Asking;
using corda::python::Calls;
using corda::python::PyFilm;
using Pixels = py::array_t<std::uint8_t, py::array::c_style>;

/// Hands the pixels of a picture to numpy, which frees them.
py::array_t<std::uint8_t> to_array(corda::Image image) {
    auto owned = std::make_unique<corda::Image>(std::move(image));
    const std::vector<py::ssize_t> shape{owned->height(), owned->width(), 4};
    std::uint8_t* const data = owned->data();
    const py::capsule owner(owned.release(), [](void* kept) { delete static_cast<corda::Image*>(kept); });
    return py::array_t<std::uint8_t>(shape, data, owner);
}

/// A copy of an array of shape (height, width, 3 or 4).
corda::Image to_image(const py::object& picture) {
    // Other numbers are refused: 0.0 .. 1.0 as bytes would all be black, and equal.
    if (!py::isinstance<py::array_t<std::uint8_t>>(picture))
        throw py::type_error(
            "a picture is a numpy array of uint8; scale it to 0 .. 255, then convert it by "
            ".astype(numpy.uint8)");
    const Pixels pixels(picture);
    if (pixels.ndim() != 3 || (pixels.shape(2) != 3 && pixels.shape(2) != 4))
        throw py::value_error(
            "a picture is an array of uint8 of shape (height, width, 4), or (height, width, 3)");
    const py::ssize_t most = corda::kMaxSidePx;
    if (pixels.shape(0) < 1 || pixels.shape(1) < 1 || pixels.shape(0) > most || pixels.shape(1) > most)
        throw py::value_error("each side of a picture has 1 to " + std::to_string(most) + " pixels");
    corda::Image image(static_cast<int>(pixels.shape(1)), static_cast<int>(pixels.shape(0)));
    const bool has_alpha = pixels.shape(2) == 4;
    if (has_alpha) {
        std::memcpy(image.data(), pixels.data(), image.size_bytes());
        return image;
    }
    const std::uint8_t* from = pixels.data();
    for (std::uint8_t* to = image.data(); to != image.data() + image.size_bytes(); to += 4, from += 3) {
        std::copy(from, from + 3, to);
        to[3] = 255;
    }
    return image;
}

py::dict plan(const PyFilm& film) {
    return film.with_film([](const corda::Film& shown) {
        const corda::Plan& chosen = shown.plan();
        const auto estimate_px = shown.error_estimate_px();
        const py::gil_scoped_acquire hold;
        py::list methods;
        for (const corda::BodyPlan& body : chosen.bodies)
            methods.append(std::string(corda::method_name(body)));
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
    return film.with_film([](const corda::Film& shown) {
        const corda::CameraDef& def = shown.camera();
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
    corda::RenderDef def{.force = force, .resume = resume};
    def.on_progress = [&](std::int64_t done, std::int64_t total) { return asking(done, total); };
    const corda::Rendered rendered = film.with_film(
        [&](const corda::Film& shown) { return corda::render_video(shown, path, def); }, asking);
    if (!rendered.complete) {
        throw corda::Error(corda::ExitCode::kInterrupted,
                           rendered.frames == 0
                               ? "stopped by on_progress; nothing was written"
                               : "stopped by on_progress; the frames so far are in '" + path + "'");
    }
    return rendered.frames;
}

/// The ending of a video that browsers play, and the film that it is to be made of if `film` does not fit it:
/// with even sides, as render --pad makes them, and the default encoder.
std::pair<std::string, std::unique_ptr<PyFilm>> for_browser(const PyFilm& film, const std::string& backend,
                                                            bool require_gpu) {
    corda::Scene scene = film.film().scene();
    const bool is_opaque = !scene.style.background || scene.style.background->is_opaque();
    const corda::EncoderDef encoder = scene.video.encoder;
    const bool is_default =
        encoder.codec.empty() && encoder.preset.empty() && encoder.pix == corda::PixelChoice::kAuto;
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

void add_errors(py::module_& module) {
    static py::exception<corda::Error> error(module, "Error");
    py::register_exception_translator(
        [](std::exception_ptr thrown) {  // NOLINT(performance-unnecessary-value-param): pybind11 wants it so
            try {
                if (thrown) std::rethrow_exception(thrown);
            } catch (const corda::Error& raised) {
                const py::object instance =
                    py::reinterpret_borrow<py::object>(error.ptr())(corda::python::text_of(raised.what()));
                instance.attr("code") = static_cast<int>(raised.code());
                PyErr_SetObject(error.ptr(), instance.ptr());
            }
        });
}

using Numbers = py::array_t<double, py::array::c_style>;
using Given = std::pair<Numbers, Numbers>;

/// The motion of the arrays `times`, (n), and `positions`, (n, particles, 2).
corda::GivenMotion motion_of(const Given& given) {
    const auto& [times, positions] = given;
    std::vector<corda::Vec2> positions_m;
    for (const double* at = positions.data(); at != positions.data() + positions.size(); at += 2)
        positions_m.push_back({at[0], at[1]});
    return {std::vector<double>(times.data(), times.data() + times.size()), std::move(positions_m)};
}

void add_film(py::module_& module) {
    using corda::Film;
    py::class_<PyFilm> film(module, "Film");
    film.def(py::init([](const std::string& text, const std::string& source, bool is_path,
                         const std::vector<std::string>& settings, const std::string& backend,
                         bool require_gpu, const std::optional<Given>& given) {
            corda::Scene scene = Asking().run([&] {
                return is_path ? corda::load_scene(source, settings)
                               : corda::parse_scene(text, source, settings);
            });
            if (given) give_motion(scene, motion_of(*given));
            return std::make_unique<PyFilm>(scene, backend, require_gpu);
        }))
        .def("frame_count", [](const PyFilm& film) { return film.film().frame_count(); })
        .def("size",
             [](const PyFilm& film) {
                 const corda::VideoDef& video = film.film().scene().video;
                 return std::pair(video.width_px, video.height_px);
             })
        .def("fps",
             [](const PyFilm& film) {
                 const corda::Rational fps = film.film().scene().video.fps.rational();
                 return std::pair(fps.num, fps.den);
             })
        .def("frame",
             [](const PyFilm& film, std::int64_t k) {
                 return to_array(film.with_film([k](const Film& shown) { return shown.frame(k); }));
             })
        .def("still",
             [](const PyFilm& film, double time_s, double shutter) {
                 return to_array(
                     film.with_film([=](const Film& shown) { return shown.still(time_s, shutter); }));
             })
        .def("for_browser", &for_browser)
        .def("positions", [](const PyFilm& film) { return corda::python::label(film, "positions"); })
        .def("velocities", [](const PyFilm& film) { return corda::python::label(film, "velocities"); })
        .def("tensions", [](const PyFilm& film) { return corda::python::label(film, "tensions"); })
        .def("energy", [](const PyFilm& film) { return corda::python::label(film, "energy"); })
        .def("times", &corda::python::times)
        .def("mask", &corda::python::mask)
        .def("to_pixels", &corda::python::to_pixels)
        .def("plan", &plan)
        .def("camera", &camera)
        .def("save", &save);
    corda::python::add_figures(module, film);
}

}  // namespace

PYBIND11_MODULE(_corda, module) {
    module.attr("__version__") = CORDA_VERSION;
    add_errors(module);
    add_film(module);
    corda::python::add_sweep(module);
    module.def("keep_memory", &corda::keep_memory);
    module.def("begin_end", &Calls::begin_end);
    module.def("forget_calls", &Calls::forget);
    module.def("compare", [](const py::object& a, const py::object& b) {
        const auto picture_of = [](const py::object& given) {
            if (!py::isinstance<py::bytes>(given)) return corda::Picture{.image = to_image(given)};
            return Asking().run([path = given.cast<std::string>()] { return corda::read_picture(path); });
        };
        const std::pair pictures(picture_of(a), picture_of(b));
        const corda::Difference found =
            Asking().run([&] { return corda::compare(pictures.first, pictures.second); });
        return py::make_tuple(found.same_size, found.equal, found.max, found.mean, found.share);
    });
    module.def("write_png", [](const std::string& path, const py::object& picture, bool force) {
        Asking().run([&, image = to_image(picture)] { corda::write_png(path, image, {}, {.force = force}); });
    });
    module.def(
        "check_golden",
        [](const py::object& picture, const std::string& name, const std::string& folder,
           const std::array<std::optional<double>, 3>& limits, const PyFilm* film, const std::string& rerun) {
            const corda::testing::GoldenOptions options{.folder = folder,
                                                        .limits = {limits[0], limits[1], limits[2]},
                                                        .film = film == nullptr ? nullptr : &film->film(),
                                                        .rerun = rerun};
            const auto outcome = Asking().run([&, image = to_image(picture)] {
                return corda::testing::check_golden(image, name, options);
            });
            return std::tuple(outcome.matches, outcome.written, outcome.message);
        });
    module.def("read_png", [](const std::string& path) {
        return to_array(Asking().run([&] { return corda::read_png(path); }));
    });
}
