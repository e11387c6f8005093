#include "labels.hpp"

#include <algorithm>
#include <array>
#include <bit>

#include "corda/core/cancel.hpp"
#include "corda/film/draw.hpp"
#include "corda/film/motion.hpp"

namespace corda::python {
namespace {

static_assert(std::endian::native == std::endian::little, "arrays are little endian");

void append(std::span<const double> numbers, std::string& data) {
    data.append(reinterpret_cast<const char*>(numbers.data()), numbers.size_bytes());
}

/// Appends pairs of all particles, each shifted.
void append_pairs(std::span<const double> x, std::span<const double> y, Vec2 shift, std::string& data) {
    for (std::size_t i = 0; i < x.size(); ++i) append(std::array{shift.x + x[i], shift.y + y[i]}, data);
}

using Dimensions = std::vector<std::int64_t>;

Dimensions particle_pairs(const Film& film) {
    return {static_cast<std::int64_t>(film.system().particle_count()), 2};
}

constexpr std::array<Label, 7> kLabels{{
    {"times", false, [](const Film&) { return Dimensions(); },
     [](const Film&, const film::Instant& frame, std::string& data) {
         append(std::array{frame.state.time_s}, data);
     }},
    {"positions", false, &particle_pairs,
     [](const Film& film, const film::Instant& frame, std::string& data) {
         append_pairs(frame.state.x_m, frame.state.y_m, film.system().origin_m, data);
     }},
    {"velocities", false, &particle_pairs,
     [](const Film&, const film::Instant& frame, std::string& data) {
         append_pairs(frame.state.vx_m_s, frame.state.vy_m_s, {}, data);
     }},
    {"tensions", false,
     [](const Film& film) { return Dimensions{static_cast<std::int64_t>(film.system().link_count())}; },
     [](const Film& film, const film::Instant& frame, std::string& data) {
         for (const Body& body : film.system().bodies)
             append(std::span(frame.state.tension_n).subspan(body.first_bar, body.link_count), data);
     }},
    {"energy", false, [](const Film&) { return Dimensions{3}; },
     [](const Film&, const film::Instant& frame, std::string& data) {
         for (const film::Series& one : {film::kSeries.kinetic, film::kSeries.potential, film::kSeries.total})
             append(std::array{one.value(frame)}, data);
     }},
    {"pixels", false, &particle_pairs,
     [](const Film& film, const film::Instant& frame, std::string& data) {
         const Vec2 origin_m = film.system().origin_m;
         std::vector<Vec2> points_m;
         for (std::size_t i = 0; i < frame.state.x_m.size(); ++i)
             points_m.push_back({origin_m.x + frame.state.x_m[i], origin_m.y + frame.state.y_m[i]});
         for (const Vec2 pixel : film.to_pixels(points_m, frame.state.time_s))
             append(std::array{pixel.x, pixel.y}, data);
     }},
    {"mask", true,
     [](const Film& film) {
         return Dimensions{film.scene().video.height_px, film.scene().video.width_px};
     },
     [](const Film& film, const film::Instant& frame, std::string& data) {
         const std::vector<std::uint8_t> mask = film::mask(film.look(), frame.state);
         data.append(mask.begin(), mask.end());
     }},
}};

}  // namespace

const Label* find_label(std::string_view name) {
    const auto found = std::ranges::find(kLabels, name, &Label::name);
    return found == kLabels.end() ? nullptr : &*found;
}

std::vector<Array> read_labels(const Film& film, std::span<const Label* const> labels, std::int64_t frames) {
    std::vector<Array> arrays;
    for (const Label* const label : labels) {
        Dimensions shape = label->shape(film);
        shape.insert(shape.begin(), frames);
        std::size_t bytes = label->is_bytes ? 1 : sizeof(double);
        for (const std::int64_t count : shape) bytes *= static_cast<std::size_t>(count);
        arrays.push_back({std::string(label->name), label->is_bytes, std::move(shape), {}});
        arrays.back().data.reserve(bytes);
    }
    const film::SeriesSource source(film.motion());
    for (std::int64_t k = 0; k < frames; ++k) {
        check_cancelled();
        const double time_s = film.time_s(k);
        film.motion().for_each({&time_s, 1}, [&](const State& state, const Figures& figures) {
            const film::Instant frame(source, state, figures);
            for (std::size_t i = 0; i < labels.size(); ++i) labels[i]->append(film, frame, arrays[i].data);
        });
    }
    return arrays;
}

}  // namespace corda::python
