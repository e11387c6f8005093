#include "corda/sweep/sample.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <new>

#include "corda/core/cancel.hpp"
#include "corda/core/text.hpp"
#include "corda/pipeline/plan_text.hpp"

namespace corda::sweep {
namespace {

/// All that the .json of a sample says.
Json info_of(Film& film, const SweepDef& sweep, const Sample& sample) {
    const VideoDef& video = film.scene().video;
    const CameraDef& camera = film.camera();
    Json parameters = Json::object();
    for (const auto& [key, value] : sample.parameters) parameters[key] = value;
    Json summary = Json::object();
    for (const SummaryColumn& column : summary_columns())
        if (std::ranges::find(sweep.summary, column.name) != sweep.summary.end())
            summary[std::string(column.name)] = or_null(sample.summary.*column.value);
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
            {"error_estimate_m", or_null(sample.summary.error_estimate_m)},
            {"error_estimate_px", or_null(sample.summary.error_estimate_px)},
            {"horizon_s", or_null(sample.summary.horizon_s)},
            {"summary", summary}};
}

}  // namespace

bool is_refusal(ExitCode code) {
    return code == ExitCode::kInvalidScene || code == ExitCode::kUsage || code == ExitCode::kDiverged;
}

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
        if (is_interruption(error.code())) throw;
        if (!is_refusal(error.code())) throw_error(error.code(), "sample {}: {}", sample.key, error.what());
        sample.failure = {error.code(), error.what()};
        sample.arrays.clear();
        sample.pictures.clear();
    } catch (const std::bad_alloc&) {
        throw_error(ExitCode::kTemporary,
                    "sample {}: out of memory; a smaller scene or picture, or fewer jobs, may help",
                    sample.key);
    }
    return sample;
}

void SampleMaker::make_of(const Scene& scene, Sample& sample) {
    FilmDef def = film_;
    def.readings = {.velocities = true, .tensions = true, .unknown_tensions = true};
    Film film(scene, std::move(def));
    SummaryReader summary(film);
    sample.arrays = read_labels(film, sweep_->labels, film.frame_count(),
                                [&summary](const State& state) { summary.add(state); });
    sample.summary = summary.summary();
    sample.info = info_of(film, *sweep_, sample);
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
