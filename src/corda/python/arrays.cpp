#include "py_film.hpp"

#include <span>
#include <utility>
#include <vector>

namespace corda::python {

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

}  // namespace corda::python
