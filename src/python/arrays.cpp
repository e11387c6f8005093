#include "py_film.hpp"

#include <algorithm>
#include <cstddef>
#include <vector>

namespace corda::python {
namespace {

/// An array of shape (frames, `rows`, `columns`), without the last if that is 0. write(film, state, to)
/// writes a frame and returns its end. The array is made before the interpreter's lock is released.
template <class Write>
py::array_t<double> per_frame(PyFilm& film, bool needs_fields, std::size_t rows, std::size_t columns,
                              const Write& write) {
    const std::int64_t frames = film.constant().frame_count();
    std::vector<py::ssize_t> shape{frames, static_cast<py::ssize_t>(rows)};
    if (columns > 0) shape.push_back(static_cast<py::ssize_t>(columns));
    py::array_t<double> all(shape);
    double* to = all.mutable_data();
    const auto write_all = [&](Film& its) {
        for (std::int64_t k = 0; k < frames; ++k) {
            check_cancelled();
            to = write(its, its.state(k), to);
        }
        return true;
    };
    needs_fields ? film.with_fields(write_all) : film.with_film(write_all);
    return all;
}

/// Pairs x, y of all particles.
double* write_pairs(const std::vector<double>& x, const std::vector<double>& y, Vec2 origin, double* to) {
    for (std::size_t i = 0; i < x.size(); ++i) {
        *to++ = origin.x + x[i];
        *to++ = origin.y + y[i];
    }
    return to;
}

}  // namespace

py::array_t<double> positions(PyFilm& film) {
    const System& system = film.constant().system();
    return per_frame(film, false, system.particle_count(), 2, [&](Film&, const State& state, double* to) {
        return write_pairs(state.x_m, state.y_m, system.origin_m, to);
    });
}

py::array_t<double> velocities(PyFilm& film) {
    const System& system = film.constant().system();
    return per_frame(film, true, system.particle_count(), 2, [](Film&, const State& state, double* to) {
        return write_pairs(state.vx_m_s, state.vy_m_s, {}, to);
    });
}

py::array_t<double> tensions(PyFilm& film) {
    const System& system = film.constant().system();
    return per_frame(film, true, system.link_count(), 0, [&](Film&, const State& state, double* to) {
        for (const Body& body : system.bodies)
            to = std::copy_n(state.tension_n.data() + body.first_bar, body.link_count, to);
        return to;
    });
}

py::array_t<double> energy(PyFilm& film) {
    return per_frame(film, true, 3, 0, [](Film& its, const State&, double* to) {
        const Energy energy = its.energy();
        *to++ = energy.kinetic_j;
        *to++ = energy.potential_j();
        *to++ = energy.kinetic_j + energy.potential_j();
        return to;
    });
}

py::array_t<double> times(const PyFilm& film) {
    const Film& its = film.constant();
    std::vector<double> all;
    for (std::int64_t k = 0; k < its.frame_count(); ++k) all.push_back(its.time_s(k));
    return py::array_t<double>(static_cast<py::ssize_t>(all.size()), all.data());
}

py::array_t<std::uint8_t> mask(PyFilm& film, std::int64_t k) {
    const std::vector<std::uint8_t> pixels = film.with_film([k](Film& its) { return its.mask(k); });
    const VideoDef& video = film.constant().scene().video;
    return py::array_t<std::uint8_t>({video.height_px, video.width_px}, pixels.data());
}

py::array_t<double> to_pixels(PyFilm& film, const Points& points_m) {
    if (points_m.ndim() < 1 || points_m.shape(points_m.ndim() - 1) != 2)
        throw py::value_error("points are an array of shape (..., 2)");
    const std::vector<py::ssize_t> shape(points_m.shape(), points_m.shape() + points_m.ndim());
    std::vector<Vec2> points;
    for (const double* at = points_m.data(); at != points_m.data() + points_m.size(); at += 2)
        points.push_back({at[0], at[1]});
    const std::vector<Vec2> pixels = film.with_film([&](Film& its) { return its.to_pixels(points); });
    py::array_t<double> all(shape);
    double* to = all.mutable_data();
    for (const Vec2 pixel : pixels) {
        *to++ = pixel.x;
        *to++ = pixel.y;
    }
    return all;
}

}  // namespace corda::python
