// The C++ half of the Python module `corda`: errors, pictures and goldens. Its classes are in py_film.cpp and
// py_sweep.cpp.
#include <pybind11/stl.h>

#include <corda/core/machine.hpp>
#include <corda/golden/check_golden.hpp>
#include <corda/golden/compare.hpp>

#include <algorithm>
#include <array>
#include <cstring>
#include <optional>
#include <tuple>

#include "py_film.hpp"

namespace {

namespace py = pybind11;
using corda::python::Asking;
using corda::python::Calls;
using corda::python::PyFilm;
using Pixels = py::array_t<std::uint8_t, py::array::c_style>;

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

}  // namespace

PYBIND11_MODULE(_corda, module) {
    module.attr("__version__") = CORDA_VERSION;
    add_errors(module);
    corda::python::add_film(module);
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
        return corda::python::to_numpy(Asking().run([&] { return corda::read_png(path); }));
    });
}
