#include "study_picture.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "commands.hpp"
#include "corda/core/error.hpp"
#include "corda/media/picture_quality.hpp"
#include "corda/media/video_reader.hpp"
#include "corda/media/video_writer.hpp"
#include "corda/render/frame_renderer.hpp"
#include "corda/scene/auto_plan.hpp"
#include "corda/scene/player.hpp"

namespace corda::app {
namespace {

namespace fs = std::filesystem;

constexpr const char* kSwing = R"(schema = 1
[[rope]]
line   = { particles = 40, from = [0.0, 50.0], step = [0.1, -1.0] }
mass   = 1.0
pinned = [0]
[video]
fps = 60
)";
constexpr double kForever = std::numeric_limits<double>::infinity();
constexpr double kReferenceTolerance = 1e-13;
constexpr int kReferenceStepsPerFrame = 64;
constexpr std::array<const char*, 6> kPresets{"ultrafast", "superfast", "veryfast", "fast", "medium", "slow"};

/// A folder for trial videos, removed with all in it.
class TemporaryFolder {
  public:
    TemporaryFolder() : path_((fs::temp_directory_path() / "corda-study-XXXXXX").string()) {
        if (mkdtemp(path_.data()) == nullptr) {
            throw Error(ExitCode::kIo,
                        fmt::format("cannot make a folder for trial videos in {}; TMPDIR names "
                                    "another place",
                                    fs::temp_directory_path().string()));
        }
    }
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;
    ~TemporaryFolder() {
        std::error_code ignored;
        fs::remove_all(path_, ignored);
    }

    [[nodiscard]] std::string video() const { return path_ + "/trial.mp4"; }

  private:
    std::string path_;
};

/// One way to solve the scene.
struct Setting {
    std::string series;
    sim::SolverDef solver;
};

std::vector<Setting> list_settings(double frame_s) {
    std::vector<Setting> settings;
    settings.push_back({"relaxation, reach 7", sim::relaxation_solver(frame_s, 7, 1)});
    for (const int steps : {2, 8}) {
        settings.push_back(
            {"relaxation, reach 1, 40 sweeps", sim::relaxation_solver(frame_s / steps, 1, 40)});
    }
    for (const int order : {2, 4}) {
        for (const int steps : {2, 4, 8, 16}) {
            settings.push_back(
                {fmt::format("rope, order {}", order), sim::rope_solver(order, frame_s / steps)});
        }
    }
    for (const double tolerance : {1e-2, 1e-4, 1e-6, 1e-8, 1e-10}) {
        settings.push_back({"exact", sim::exact_solver(tolerance)});
    }
    sim::SolverDef automatic;
    automatic.reach = 1;  // the links alone: bars of a longer reach would be another system
    settings.push_back({"auto, 0.1 px", automatic});
    return settings;
}

/// What a whole render took, in seconds. Starts as longer than any.
struct RenderTime {
    double simulate_s = kForever;  ///< planning, the camera's rehearsal and the stepping
    double draw_s = kForever;
    double encode_s = kForever;  ///< to a finished and verified file
    double whole_s = kForever;

    void keep_shortest(const RenderTime& other) {
        simulate_s = std::min(simulate_s, other.simulate_s);
        draw_s = std::min(draw_s, other.draw_s);
        encode_s = std::min(encode_s, other.encode_s);
        whole_s = std::min(whole_s, other.whole_s);
    }
};

RenderTime render_once(scene::Scene scene, const std::string& path) {
    RenderTime time;
    double start_s = now_s();
    const auto lap = [&start_s] {
        const double now = now_s();
        return now - std::exchange(start_s, now);
    };
    (void)scene::settle_method(scene);
    scene::Player player(scene);
    time.simulate_s = lap();
    render::FrameRenderer renderer(scene.video.width_px, scene.video.height_px);
    time.draw_s = lap();
    media::VideoWriter writer(path, scene.video, {});
    time.encode_s = lap();
    for (std::int64_t k = 0; k < scene::frame_count(scene); ++k) {
        const double stepped_s = player.run().wall_s();
        const PixelRect damage = renderer.render(player.at(scene.video.fps.time_s(k)));
        const double step_s = player.run().wall_s() - stepped_s;
        time.simulate_s += step_s;
        time.draw_s += lap() - step_s;
        writer.write(renderer.image(), damage);
        time.encode_s += lap();
    }
    writer.finish();
    time.encode_s += lap();
    time.whole_s = time.simulate_s + time.draw_s + time.encode_s;
    return time;
}

/// Renders the chapter's scene in many ways and fills its chapter.
class PictureStudy {
  public:
    PictureStudy(const PictureStudyDef& def, const study::Progress& progress)
        : progress_(progress),
          scene_(def.scene ? *def.scene : scene::parse_scene(kSwing, "the swing")),
          repeats_(def.quick ? 1 : 5) {
        scene_.video.width_px = def.quick ? 640 : 1280;
        scene_.video.height_px = def.quick ? 360 : 720;
        const FrameRate fps = scene_.video.fps;
        frames_ = std::min<std::int64_t>(def.quick ? 30 : 120, fps.frame_count(scene_.world.duration_s));
        scene_.world.duration_s = fps.time_s(frames_);
        settings_ = list_settings(fps.interval_s());
        pieces_ = 1 + repeats_ * static_cast<int>(settings_.size() + kPresets.size());
    }

    study::Chapter run() {
        chapter_.title = "Pictures: the whole way to a video";
        report("reference");
        find_reference();
        compare_solvers();
        compare_presets();
        return std::move(chapter_);
    }

  private:
    using States = std::vector<sim::State>;

    void report(const std::string& what) { progress_(done_++, pieces_, what); }

    [[nodiscard]] scene::Scene with(const sim::SolverDef& solver) const {
        scene::Scene scene = scene_;
        scene.solver = solver;
        return scene;
    }

    [[nodiscard]] States positions(const sim::SolverDef& solver) const {
        scene::Run run(with(solver), sim::Figured::kNo);
        States states;
        for (std::int64_t k = 0; k < frames_; ++k) states.push_back(run.at(scene_.video.fps.time_s(k)));
        return states;
    }

    /// Largest displayed distance of a particle from the reference.
    [[nodiscard]] double error_px(const States& states) const {
        double largest_m = 0.0;
        for (std::size_t k = 0; k < states.size(); ++k) {
            for (std::size_t i = 0; i < states[k].x_m.size(); ++i) {
                largest_m = std::max(largest_m, std::hypot(states[k].x_m[i] - reference_[k].x_m[i],
                                                           states[k].y_m[i] - reference_[k].y_m[i]));
            }
        }
        return largest_m * pixels_per_metre_;
    }

    /// Takes `exact` as the truth, or `rope` where exact cannot run the scene, and checks it by rope.
    void find_reference() {
        const double frame_s = scene_.video.fps.interval_s();
        truth_ = sim::exact_solver(kReferenceTolerance);
        try {
            reference_ = positions(truth_);
        } catch (const Error&) {
            truth_ = sim::rope_solver(8, frame_s / kReferenceStepsPerFrame);
            reference_ = positions(truth_);
        }
        pixels_per_metre_ = scene::Player(with(truth_)).camera().pixels_per_metre();
        const sim::SolverDef check = sim::rope_solver(8, frame_s / (2 * kReferenceStepsPerFrame));
        chapter_.paragraphs.push_back(fmt::format(
            "{} frames of {}x{} at {} a second, {:.4g} pixels per metre. The truth is {}; {}, another "
            "formulation, differs from it by at most {:.2g} px.",
            frames_, scene_.video.width_px, scene_.video.height_px, scene_.video.fps.rational().text(),
            pixels_per_metre_, describe(truth_), describe(check), error_px(positions(check))));
    }

    /// Solver, steps a frame and tolerance of a setting.
    [[nodiscard]] std::vector<study::Cell> named(const std::string& series,
                                                 const sim::SolverDef& solver) const {
        std::vector<study::Cell> cells{series, {}, {}};
        if (solver.method == sim::Method::kExact) cells[2] = solver.tolerance;
        if (solver.step_s) cells[1] = std::round(scene_.video.fps.interval_s() / *solver.step_s);
        return cells;
    }

    /// The row of a setting up to its error; whole, with the reason, where it fails.
    [[nodiscard]] std::vector<study::Cell> error_row(const Setting& setting) const {
        std::vector<study::Cell> row = named(setting.series, setting.solver);
        try {
            scene::Scene settled = with(setting.solver);
            if (scene::settle_method(settled)) {
                row = named(fmt::format("{}: {}", setting.series, sim::method_name(settled.solver.method)),
                            settled.solver);
            }
            row.emplace_back(error_px(positions(settled.solver)));
        } catch (const Error& error) {
            const bool is_outcome =
                error.code() == ExitCode::kDiverged || error.code() == ExitCode::kInvalidScene;
            if (!is_outcome) throw;
            row.resize(kFailureColumn);
            row.emplace_back(error.what());
        }
        return row;
    }

    /// Renders all scenes in turn, as often as there are repeats, so that what else the machine does meets
    /// all of them alike; calls `after_first` once a scene.
    std::vector<RenderTime> time_renders(const std::vector<scene::Scene>& scenes,
                                         const std::function<void(std::size_t)>& after_first) {
        std::vector<RenderTime> times(scenes.size());
        for (int repeat = 0; repeat < repeats_; ++repeat) {
            for (std::size_t i = 0; i < scenes.size(); ++i) {
                report(fmt::format("render {} of {}", i + 1, scenes.size()));
                times[i].keep_shortest(render_once(scenes[i], folder_.video()));
                if (repeat == 0 && after_first) after_first(i);
            }
        }
        return times;
    }

    [[nodiscard]] std::vector<std::vector<study::Cell>> solver_rows() {
        std::vector<std::vector<study::Cell>> rows;
        std::vector<scene::Scene> scenes;
        std::vector<std::size_t> row_of;
        for (const Setting& setting : settings_) {
            rows.push_back(error_row(setting));
            if (rows.back().size() > kFailureColumn) continue;
            row_of.push_back(rows.size() - 1);
            scenes.push_back(with(setting.solver));
        }
        const std::vector<RenderTime> times = time_renders(scenes, {});
        for (std::size_t i = 0; i < times.size(); ++i) {
            const RenderTime& time = times[i];
            auto& row = rows[row_of[i]];
            row.insert(row.end(), {1e3 * time.whole_s, 1e3 * time.simulate_s, 1e3 * time.draw_s,
                                   1e3 * time.encode_s, static_cast<double>(frames_) / time.whole_s, ""});
        }
        return rows;
    }

    /// Puts the figures of a row that has some into a plot of errors against the times in `column`.
    static void add_point(const std::string& series, const std::vector<study::Cell>& row, std::size_t column,
                          study::Plot& plot) {
        if (!std::holds_alternative<double>(row[kErrorColumn])) return;
        if (plot.series.empty() || plot.series.back().name != series) plot.series.push_back({series, {}});
        plot.series.back().points.emplace_back(std::get<double>(row[column]),
                                               std::get<double>(row[kErrorColumn]));
    }

    [[nodiscard]] static std::string simulating_share(const study::Table& table) {
        double least = kForever;
        double most = 0.0;
        for (const auto& row : table.rows) {
            if (!std::holds_alternative<double>(row[kWholeColumn])) continue;
            const double share = std::get<double>(row[kSimulateColumn]) / std::get<double>(row[kWholeColumn]);
            least = std::min(least, share);
            most = std::max(most, share);
        }
        if (most == 0.0) return "No solver ran the scene.";
        return fmt::format(
            "Simulating is {:.2g} % to {:.2g} % of the whole render; the rest is drawing and "
            "encoding.",
            100.0 * least, 100.0 * most);
    }

    void compare_solvers() {
        study::Table table;
        table.id = "picture_solvers";
        table.title = "The whole render by solver";
        table.columns = {{"solver", "Solver"},
                         {"steps_per_frame", "Steps a frame, at least"},
                         {"tolerance", "Tolerance"},
                         {"error_px", "Largest displayed error / px"},
                         {"whole_ms", "Whole render / ms"},
                         {"simulate_ms", "Simulating / ms"},
                         {"draw_ms", "Drawing / ms"},
                         {"encode_ms", "Encoding / ms"},
                         {"frames_per_s", "Frames / s"},
                         {std::string(study::kFailureKey), "Failed because"}};
        table.note = fmt::format(
            "The shortest of {} renders each, column by column. Simulating holds the plan of auto and the "
            "camera's rehearsal of "
            "the motion; encoding holds the finished file's check by decoding it; starting OpenGL is in "
            "none.",
            repeats_);
        study::Plot whole{"picture_error_whole",
                          "Displayed error against the time of the whole render",
                          "Whole render / ms",
                          "Largest displayed error / px",
                          true,
                          true,
                          {}};
        study::Plot simulating{"picture_error_simulating",
                               "Displayed error against the time of simulating",
                               "Simulating / ms",
                               "Largest displayed error / px",
                               true,
                               true,
                               {}};
        table.rows = solver_rows();
        chapter_.paragraphs.push_back(simulating_share(table));
        for (std::size_t i = 0; i < settings_.size(); ++i) {
            add_point(settings_[i].series, table.rows[i], kWholeColumn, whole);
            add_point(settings_[i].series, table.rows[i], kSimulateColumn, simulating);
        }
        chapter_.tables.push_back(std::move(table));
        chapter_.plots.push_back(std::move(simulating));
        chapter_.plots.push_back(std::move(whole));
    }

    /// Luma figures of the video at folder_.video() against the frames it was made of, drawn again.
    struct Quality {
        double psnr_db = 0.0;
        double ssim = 0.0;
    };
    [[nodiscard]] Quality quality(const scene::Scene& scene) const {
        scene::Player player(scene);
        render::FrameRenderer renderer(scene.video.width_px, scene.video.height_px);
        media::VideoReader reader(folder_.video());
        media::Yuv420Image drawn(scene.video.width_px, scene.video.height_px);
        media::Yuv420Image decoded;
        double squares = 0.0;
        double ssim = 0.0;
        for (std::int64_t k = 0; k < frames_; ++k) {
            const PixelRect damage = renderer.render(player.at(scene.video.fps.time_s(k)));
            media::convert_to_yuv420(renderer.image(), damage, drawn);
            if (!reader.read(decoded)) {
                throw Error(ExitCode::kMismatch, fmt::format("the trial video ends before frame {}", k));
            }
            squares += media::luma_mean_square(drawn, decoded);
            ssim += media::luma_ssim(drawn, decoded);
        }
        const auto count = static_cast<double>(frames_);
        return {media::psnr_db(squares / count), ssim / count};
    }

    void compare_presets() {
        study::Table table;
        table.id = "picture_presets";
        table.title = "x264's presets on the same frames";
        table.columns = {
            {"preset", "Preset"}, {"psnr_db", "Luma PSNR / dB"},  {"one_minus_ssim", "1 - luma SSIM"},
            {"bytes", "Bytes"},   {"frames_per_s", "Frames / s"}, {"encode_ms", "Encoding / ms"}};
        table.note = fmt::format(
            "CRF {}, {} threads. Frames a second of encoding to a finished and checked file, without "
            "simulating "
            "and drawing. PSNR is that of the mean square over all frames, SSIM (Wang and others 2004, "
            "windows "
            "of 8x8) the mean over them.",
            scene_.video.encoder.crf, scene_.video.encoder.threads);
        study::Plot size{
            "picture_preset_bytes", "x264: size against speed", "Frames / s", "Bytes", true, true, {}};
        study::Plot loss{
            "picture_preset_loss", "x264: loss against speed", "Frames / s", "1 - luma SSIM", true, true, {}};
        std::vector<scene::Scene> scenes;
        for (const char* preset : kPresets) {
            scenes.push_back(with(truth_));
            scenes.back().video.encoder.preset = preset;
        }
        std::vector<Quality> found(scenes.size());
        std::vector<double> bytes(scenes.size());
        const auto times = time_renders(scenes, [&](std::size_t i) {
            found[i] = quality(scenes[i]);
            bytes[i] = static_cast<double>(fs::file_size(folder_.video()));
        });
        for (std::size_t i = 0; i < scenes.size(); ++i) {
            const double loss_of_one = 1.0 - found[i].ssim;
            const double speed = static_cast<double>(frames_) / times[i].encode_s;
            table.rows.push_back(
                {kPresets[i], found[i].psnr_db, loss_of_one, bytes[i], speed, 1e3 * times[i].encode_s});
            size.series.push_back({kPresets[i], {{speed, bytes[i]}}});
            loss.series.push_back({kPresets[i], {{speed, loss_of_one}}});
        }
        chapter_.tables.push_back(std::move(table));
        chapter_.plots.push_back(std::move(size));
        chapter_.plots.push_back(std::move(loss));
    }

    static constexpr std::size_t kErrorColumn = 3;
    static constexpr std::size_t kWholeColumn = 4;
    static constexpr std::size_t kSimulateColumn = 5;
    static constexpr std::size_t kFailureColumn = 9;

    const study::Progress& progress_;
    scene::Scene scene_;
    int repeats_;
    std::int64_t frames_ = 0;
    std::vector<Setting> settings_;
    int pieces_ = 0;
    int done_ = 0;
    TemporaryFolder folder_;
    sim::SolverDef truth_;
    States reference_;
    double pixels_per_metre_ = 1.0;
    study::Chapter chapter_;
};

}  // namespace

study::Chapter picture_chapter(const PictureStudyDef& def, const study::Progress& progress) {
    return PictureStudy(def, progress).run();
}

}  // namespace corda::app
