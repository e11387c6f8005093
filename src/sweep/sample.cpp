#include "corda/sweep/sample.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <span>
#include <string_view>

#include "corda/core/cancel.hpp"
#include "corda/core/text.hpp"
#include "corda/pipeline/plan_text.hpp"

namespace corda::sweep {
namespace {

static_assert(std::endian::native == std::endian::little, "arrays are little endian");

/// Whether an error says that a scene is not one that Corda makes.
bool is_refusal(ExitCode code) {
    return code == ExitCode::kInvalidScene || code == ExitCode::kUsage || code == ExitCode::kDiverged;
}

/// Appends to an array.
class ArrayWriter {
  public:
    ArrayWriter(Sample& sample, std::string_view name, std::vector<std::int64_t> shape)
        : array_(&sample.arrays.emplace_back(Array{std::string(name), false, std::move(shape), {}})) {
        std::size_t bytes = sizeof(double);
        for (const std::int64_t count : array_->shape) bytes *= static_cast<std::size_t>(count);
        array_->data.reserve(bytes);
    }
    void add(double value) { add(std::span(&value, 1)); }
    void add(std::span<const double> values) {
        array_->data.append(reinterpret_cast<const char*>(values.data()), values.size_bytes());
    }

  private:
    Array* array_;
};

/// The labels of a film in plain data, frame by frame.
class LabelReader {
  public:
    LabelReader(Film& film, const Labels& labels, Sample& sample) : film_(&film), labels_(labels) {
        const std::int64_t frames = film.frame_count();
        const auto particles = static_cast<std::int64_t>(film.system().particle_count());
        sample.arrays.reserve(kMaxArrays);
        const auto make = [&](bool is_wanted, std::string_view name, std::vector<std::int64_t> shape) {
            shape.insert(shape.begin(), frames);
            if (is_wanted) writers_.emplace_back(sample, name, std::move(shape));
            return is_wanted ? &writers_.back() : nullptr;
        };
        writers_.reserve(kMaxArrays);
        times_ = make(true, "times", {});
        positions_ = make(labels.positions, "positions", {particles, 2});
        velocities_ = make(labels.velocities, "velocities", {particles, 2});
        tensions_ =
            make(labels.tensions, "tensions", {static_cast<std::int64_t>(film.system().link_count())});
        energy_ = make(labels.energy, "energy", {3});
        pixels_ = make(labels.pixels, "pixels", {particles, 2});
    }

    void add(const State& state) {
        const System& system = film_->system();
        times_->add(state.time_s);
        points_m_.clear();
        for (std::size_t i = 0; i < state.x_m.size(); ++i) {
            points_m_.push_back({system.origin_m.x + state.x_m[i], system.origin_m.y + state.y_m[i]});
            if (positions_ != nullptr) add_pair(*positions_, points_m_.back());
            if (velocities_ != nullptr) add_pair(*velocities_, {state.vx_m_s[i], state.vy_m_s[i]});
        }
        for (const Body& body : system.bodies)
            if (tensions_ != nullptr)
                tensions_->add(std::span(state.tension_n).subspan(body.first_bar, body.link_count));
        if (energy_ != nullptr) {
            const Energy energy = film_->energy();
            for (const double value_j :
                 {energy.kinetic_j, energy.potential_j(), energy.kinetic_j + energy.potential_j()})
                energy_->add(value_j);
        }
        if (pixels_ != nullptr)
            for (const Vec2 pixel : film_->to_pixels(points_m_)) add_pair(*pixels_, pixel);
    }

  private:
    static constexpr std::size_t kMaxArrays = 8;

    static void add_pair(ArrayWriter& to, Vec2 pair) {
        to.add(pair.x);
        to.add(pair.y);
    }

    Film* film_;
    Labels labels_;
    std::vector<ArrayWriter> writers_;
    ArrayWriter* times_;
    ArrayWriter* positions_;
    ArrayWriter* velocities_;
    ArrayWriter* tensions_;
    ArrayWriter* energy_;
    ArrayWriter* pixels_;
    std::vector<Vec2> points_m_;
};

Json number_or_null(const std::optional<double>& value) {
    return value ? Json(*value) : Json();
}

/// All that the .json of a sample says.
Json info_of(Film& film, const SweepDef& sweep, const Sample& sample) {
    const VideoDef& video = film.scene().video;
    const CameraDef& camera = film.camera();
    Json parameters = Json::object();
    for (const auto& [key, value] : sample.parameters) parameters[key] = value;
    Json summary = Json::object();
    for (const SummaryColumn& column : summary_columns())
        if (std::find(sweep.summary.begin(), sweep.summary.end(), column.name) != sweep.summary.end())
            summary[std::string(column.name)] = number_or_null(sample.summary.*column.value);
    return {{"schema", 1},
            {"corda", version()},
            {"sample", sample.number},
            {"key", sample.key},
            {"seed", sweep.seed},
            {"split", sample.split.empty() ? Json() : Json(sample.split)},
            {"parameters", parameters},
            {"frames", film.frame_count()},
            {"fps", video.fps.rational().text()},
            {"width", video.width_px},
            {"height", video.height_px},
            {"camera", {{"center", {camera.center_m->x, camera.center_m->y}}, {"height", *camera.height_m}}},
            {"px_per_m", video.height_px / *camera.height_m},
            {"method", method_names(film.plan())},
            {"error_bound_m", number_or_null(sample.summary.error_bound_m)},
            {"error_bound_px", number_or_null(sample.summary.error_bound_px)},
            {"horizon_s", number_or_null(sample.summary.horizon_s)},
            {"summary", summary}};
}

}  // namespace

std::string key_of(std::int64_t sample) {
    return fmt::format("{:06}", sample);
}

Sample SampleMaker::make(std::int64_t number) {
    Sample sample;
    sample.number = number;
    sample.key = key_of(number);
    sample.split = split_of(*sweep_, number);
    try {
        sample.parameters = parameters_of(*sweep_, number);
        make_of(scene_of(*sweep_, sample.parameters), sample);
    } catch (const Error& error) {
        if (!is_refusal(error.code())) throw;
        sample.failure = {error.code(), error.what()};
        sample.arrays.clear();
        sample.pictures.clear();
    }
    return sample;
}

void SampleMaker::make_of(const Scene& scene, Sample& sample) {
    FilmDef def = film_;
    def.readings = {.velocities = true, .tensions = true, .unknown_tensions = true};
    Film film(scene, std::move(def));
    SummaryReader summary(film);
    {
        LabelReader labels(film, sweep_->labels, sample);
        for (std::int64_t k = 0; k < film.frame_count(); ++k) {
            check_cancelled();
            const State& state = film.state(k);
            labels.add(state);
            summary.add(state);
        }
    }
    sample.summary = summary.summary();
    sample.info = info_of(film, *sweep_, sample);
    if (sweep_->labels.mask) {
        Array mask{"mask", true, {film.frame_count(), scene.video.height_px, scene.video.width_px}, {}};
        for (std::int64_t k = 0; k < film.frame_count(); ++k) {
            check_cancelled();
            const std::vector<std::uint8_t> pixels = film.mask(k);
            mask.data.append(pixels.begin(), pixels.end());
        }
        sample.arrays.push_back(std::move(mask));
    }
    if (sweep_->pictures != Pictures::kNone) draw(film, sample);
}

void SampleMaker::draw(Film& film, Sample& sample) {
    FilmRenderer renderer(film, &canvas_);
    if (sweep_->pictures == Pictures::kMp4) {
        sample.pictures = {{".mp4", video_files(film, renderer, sample.key + ".mp4").front()}};
        return;
    }
    if (sweep_->pictures == Pictures::kPng) {
        std::vector<std::string> files = video_files(film, renderer, "%06d.png");
        for (std::size_t k = 0; k < files.size(); ++k)
            sample.pictures.push_back({fmt::format(".{:06}.png", k), std::move(files[k])});
        return;
    }
    const VideoDef& video = film.scene().video;
    Array frames{"frames", true, {film.frame_count(), video.height_px, video.width_px, 4}, {}};
    for (std::int64_t k = 0; k < film.frame_count(); ++k) {
        check_cancelled();
        renderer.draw(film.time_s(k));
        const Image& image = renderer.image();
        frames.data.append(reinterpret_cast<const char*>(image.data()), image.size_bytes());
    }
    sample.arrays.push_back(std::move(frames));
}

}  // namespace corda::sweep
