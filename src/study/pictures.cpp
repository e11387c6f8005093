#include <algorithm>
#include <filesystem>
#include <memory>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "corda/core/basics.hpp"
#include "corda/core/cancel.hpp"
#include "corda/core/file.hpp"
#include "corda/core/machine.hpp"
#include "corda/media/chunks/video_writer.hpp"
#include "corda/pipeline/film_renderer.hpp"
#include "corda/pipeline/plan_text.hpp"
#include "corda/study/measure.hpp"
#include "corda/study/problems.hpp"
#include "corda/study/study.hpp"

namespace corda::study {
namespace {

constexpr const char* kSwing = R"(schema = 1
[[rope]]
line = { particles = 40, step = [0.1, -1.0] }
[solver]
method = "exact"
)";

/// A way to solve the scene.
struct SolverSetting {
    std::string series;
    std::string words;  ///< within the series; empty: those of the method that auto chose
    SolverDef solver;
    int reach = 1;
};

std::vector<SolverSetting> list_settings(double frame_s) {
    const auto words = [](int steps) { return fmt::format("{} steps per frame", steps); };
    std::vector<SolverSetting> settings{
        {"relaxation, reach 7", "1 step per frame", RelaxationDef{frame_s}, 7}};
    for (const int steps : {2, 8}) {
        settings.push_back(
            {"relaxation, reach 1, 40 sweeps", words(steps), RelaxationDef{frame_s / steps, 40}});
    }
    for (const int steps : {2, 4, 8, 16})
        settings.push_back({"rattle, order 4", words(steps), RattleDef{4, frame_s / steps}});
    for (const double tolerance : {1e-2, 1e-4, 1e-6, 1e-8})
        settings.push_back({"exact", fmt::format("tolerance {:.0e}", tolerance), ExactDef{tolerance}});
    settings.push_back({"auto, 0.1 px", "", AutoDef{0.1}});
    return settings;
}

/// How long the parts of a render take, in ms.
struct RenderTime {
    report::Times simulate_ms;
    report::Times draw_ms;
    report::Times encode_ms;  ///< up to the verified file
    report::Times whole_ms;
};

FilmDef film_of(const StudyDef& def) {
    FilmDef film = def.film;
    film.on_progress = [](std::int64_t, std::int64_t) {
        check_cancelled();
        return true;
    };
    return film;
}

/// State shared by the jobs of the chapter.
struct Pictures {
    explicit Pictures(const StudyDef& def)
        : film_def(film_of(def)),
          repeats(def.quick ? 1 : 5),
          scene(def.scene ? *def.scene : parse_scene(kSwing, "the swing")) {
        constexpr std::int64_t kQuickFrames = 30;
        constexpr std::int64_t kFrames = 120;
        scene.video.width_px = def.quick ? 640 : 1280;
        scene.video.height_px = def.quick ? 360 : 720;
        const FrameRate fps = scene.video.fps;
        const std::int64_t frames = fps.frame_count(scene.world.duration_s);
        scene.world.duration_s = fps.time_s(std::min(frames, def.quick ? kQuickFrames : kFrames));
        subject.problem = problem_of(scene);
    }

    [[nodiscard]] Scene scene_with(const SolverDef& solver, int reach) const {
        Scene changed = scene;
        changed.solver = solver;
        changed.body_solvers.clear();
        for (RopeDef& rope : changed.ropes) rope.reach = reach;
        return changed;
    }

    FilmDef film_def;
    int repeats;
    Scene scene;
    Subject subject;
    std::string gl_renderer;
    TemporaryFolder folder;  ///< of trial videos
    report::Table solvers;
    report::Plot plot;
};

/// Draws and encodes a film, which took `simulate_s` to simulate, and adds the times to `time`.
void time_film(Film& film, const VideoDef& video, double simulate_s, const std::string& path,
               RenderTime& time) {
    FilmRenderer renderer(film);
    std::error_code ignored;  // the write below reports why it is still there
    std::filesystem::remove(path, ignored);
    double draw_s = 0.0;
    double encode_s = 0.0;
    double last_s = now_s();
    const auto lap = [&last_s](double& sum_s) {
        const double from_s = std::exchange(last_s, now_s());
        sum_s += last_s - from_s;
    };
    media::VideoWriter writer(path, video, {});
    lap(encode_s);
    for (std::int64_t k = 0; k < film.frame_count(); ++k) {
        check_cancelled();
        const Damage damage = renderer.draw(film.time_s(k));
        lap(draw_s);
        writer.write(renderer.image(), damage);
        lap(encode_s);
    }
    writer.finish();
    lap(encode_s);
    time.simulate_ms.add(1e3 * simulate_s);
    time.draw_ms.add(1e3 * draw_s);
    time.encode_ms.add(1e3 * encode_s);
    time.whole_ms.add(1e3 * (simulate_s + draw_s + encode_s));
}

/// Largest displayed distance of a particle from the truth, in pixels.
std::optional<double> error_px(const Pictures& pictures, Film& film, int reach) {
    std::vector<MethodDef> methods;
    for (const BodyPlan& body : film.plan().bodies) methods.push_back(body.method);
    const Problem problem = with_reach(facing(pictures.subject, methods.front()), reach);
    const double pixels_per_metre = film.scene().video.height_px / film.camera().height_m.value();
    return largest_error(problem, methods) * problem.length_m * pixels_per_metre;
}

void add_solver(const SolverSetting& setting, Pictures& pictures) {
    const Scene scene = pictures.scene_with(setting.solver, setting.reach);
    RenderTime time;
    std::string words = setting.words;
    std::optional<double> error;
    try {
        for (int repeat = 0; repeat < pictures.repeats; ++repeat) {
            const double start_s = now_s();
            Film film(scene, pictures.film_def);
            static_cast<void>(film.camera());
            static_cast<void>(film.state(film.frame_count() - 1));
            time_film(film, scene.video, now_s() - start_s, pictures.folder.file("trial.mp4"), time);
            if (repeat > 0) continue;
            if (words.empty()) words = plan_text(film.system(), film.plan());
            error = error_px(pictures, film, setting.reach);
        }
    } catch (const Error& failure) {
        if (failure.code() != ExitCode::kDiverged && failure.code() != ExitCode::kInvalidScene) throw;
        pictures.solvers.add_failed({setting.series, words}, failure.what());
        return;
    }
    const auto frames = static_cast<double>(scene.video.fps.frame_count(scene.world.duration_s));
    pictures.solvers.add({setting.series, words, report::cell_of(error), time.whole_ms.median(),
                          time.whole_ms.least(), time.whole_ms.largest(), time.simulate_ms.median(),
                          time.draw_ms.median(), time.encode_ms.median(),
                          1e3 * frames / time.whole_ms.median()});
    auto& series = pictures.plot.series;
    if (series.empty() || series.back().name != setting.series) series.push_back({setting.series, {}});
    series.back().add(error.value(), time.whole_ms.median(),
                      {time.whole_ms.least(), time.whole_ms.largest()});
}

void describe_table(Pictures& pictures) {
    report::Table& solvers = pictures.solvers;
    solvers.id = "picture_solvers";
    solvers.title = "The whole render by solver";
    solvers.columns = {{"solver", "solver"},
                       {"setting", "setting"},
                       {"error_px", "largest displayed error [px]"},
                       {"whole_ms", "whole render [ms]"},
                       {"whole_ms_least", "least"},
                       {"whole_ms_largest", "largest"},
                       {"simulate_ms", "simulating [ms]"},
                       {"draw_ms", "drawing [ms]"},
                       {"encode_ms", "encoding [ms]"},
                       {"frames_per_s", "frames per second"},
                       report::failure_column()};
    solvers.note = fmt::format(
        "Times are medians of {} renders, column by column. Simulating includes the plan of auto, and "
        "encoding the check of the finished file. Starting OpenGL is in none of them.",
        pictures.repeats);
    pictures.plot.id = "picture_error";
    pictures.plot.title = "Time of the whole render against displayed error";
    pictures.plot.x_title = "largest displayed error [px]";
    pictures.plot.y_title = "whole render [ms]";
    pictures.plot.caption =
        "Time of the whole render, from the scene to the verified video, against the largest distance of a "
        "particle from its true place in the picture. Each point is one setting of a solver; lower left is "
        "better. Bars span the fastest and the slowest render.";
}

std::string setting_paragraph(const Pictures& pictures) {
    const VideoDef& video = pictures.scene.video;
    const Subject& subject = pictures.subject;
    std::string text =
        fmt::format("{} frames of {}x{} at {} per second, drawn by {}. The truth is {}",
                    video.fps.frame_count(pictures.scene.world.duration_s), video.width_px, video.height_px,
                    video.fps.rational().text(), pictures.gl_renderer, subject.problem.truth);
    if (subject.exact_reference) text += fmt::format("; for exact it is {}", subject.exact_truth);
    return text + ".";
}

}  // namespace

ChapterWork pictures_work(const StudyDef& def) {
    const auto pictures = std::make_shared<Pictures>(def);
    describe_table(*pictures);
    // Whether OpenGL works does not depend on the scene; this one costs no simulation.
    pictures->gl_renderer = Film(parse_scene(kSwing, "the swing"), def.film).gl().renderer;
    ChapterWork work;
    work.jobs.push_back({"pictures: truth", [pictures] { find_truth(pictures->subject); }});
    for (const SolverSetting& setting : list_settings(pictures->scene.video.fps.interval_s())) {
        work.jobs.push_back({"pictures: " + setting.series, [=] { add_solver(setting, *pictures); }});
    }
    work.finish = [pictures] {
        return report::Chapter{"Pictures: from a scene to a video",
                               {setting_paragraph(*pictures)},
                               {pictures->solvers},
                               {pictures->plot}};
    };
    return work;
}

}  // namespace corda::study
