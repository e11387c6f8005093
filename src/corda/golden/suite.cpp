#include "corda/golden/suite.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <memory>
#include <mutex>

#include "corda/core/cancel.hpp"
#include "corda/core/machine.hpp"
#include "corda/core/text.hpp"
#include "corda/core/workers.hpp"
#include "corda/film/draw.hpp"
#include "corda/golden/cases.hpp"
#include "corda/media/bytes.hpp"

namespace corda::golden {
namespace {

namespace fs = std::filesystem;

/// A thread of its own draws no fewer pictures: the context that it needs takes as long as some of them.
constexpr std::size_t kMinApart = 8;

/// A scene that is being drawn.
struct Job {
    Case* scene = nullptr;
    std::optional<Film> film;
    GoldenRecord made;
    std::size_t left = 0;  ///< pictures to draw
};

/// A picture as it compares with one of its references. `settings`: of the suite.
Checked compared(const Image& drawn, const Job& job, const std::vector<Setting>& settings,
                 const std::string& path, Checked picture) {
    const Scene& scene = job.film->scene();
    const Image* const mask = job.scene->mask ? &*job.scene->mask : nullptr;
    picture.reference = path;
    picture.verdict = Verdict::kDifferent;
    Picture reference;
    try {
        reference = read_picture(path);
    } catch (const Error& error) {
        const auto kind = is_no_png(path) ? Cause::Kind::kReferenceIsNoPng : Cause::Kind::kReferenceIsDamaged;
        picture.cause = {.kind = kind, .message = error.what()};
        return picture;
    }
    const Difference difference =
        reference.deep ? compare(reference, {.image = drawn}, mask) : compare(reference.image, drawn, mask);
    if (!difference.same_size) {
        const auto size_text = [](const Image& image) {
            return fmt::format("{}x{}", image.width(), image.height());
        };
        picture.cause = {
            .kind = Cause::Kind::kSize, .stored = size_text(reference.image), .now = size_text(drawn)};
        return picture;
    }
    picture.difference = difference;
    if (difference.within(
            {.max = scene.golden->max, .mean = scene.golden->mean, .share = scene.golden->share}))
        picture.verdict = Verdict::kPassed;
    else
        picture.cause = cause_of(provenance_in(read_png_info(path)), job.made, scene, settings);
    return picture;
}

class Runner {
  public:
    Runner(const SuiteDef& def, const std::vector<std::string>& references, std::int64_t all)
        : def_(def), references_(references), all_(all) {
        report_progress(def_.on_progress, 0, all_);
    }

    void check(std::vector<Case>& cases) {
        for (Case& one : cases) queue_.push_back([this, &one] { begin(one); });
        queue_.run(threads_);
    }

    /// The pictures of an update, or those for SuiteDef::new_folder, by their names.
    [[nodiscard]] const Files& files() const { return files_; }

  private:
    /// Makes the film of a scene, and pieces of work of its pictures.
    void begin(Case& one) {
        auto job = std::make_shared<Job>();
        job->scene = &one;
        job->left = one.pictures.size();
        const Scene scene = load_scene(one.path, one.settings);
        FilmDef def = def_.film;
        def.stills_s = one.scene.golden->at_s;
        def.stills_shutter = scene.video.shutter;
        job->film.emplace(scene, def);
        job->made = record_of(*job->film);
        const std::size_t count = one.pictures.size();
        const auto pieces = std::clamp<std::size_t>(count / kMinApart, 1, static_cast<std::size_t>(threads_));
        for (std::size_t i = 0; i < pieces; ++i)
            queue_.push_front([this, job, first = count * i / pieces, end = count * (i + 1) / pieces] {
                draw(*job, first, end);
            });
    }

    void draw(Job& job, std::size_t first, std::size_t end) {
        const render::CanvasUse canvas(job.film->context_def());
        for (std::size_t i = first; i < end; ++i) {
            Checked& picture = job.scene->pictures[i];
            if (!picture.selected) continue;
            const auto start = std::chrono::steady_clock::now();
            const double shutter = job.film->scene().video.shutter;
            const bool is_empty =
                film::paint(job.film->look(), job.film->motion(), picture.time_s, shutter, *canvas).is_empty;
            const Image& drawn = canvas->image();
            picture = judged(drawn, job, picture);
            if (is_empty || has_one_color(drawn))
                picture.verdict = Verdict::kEmpty;
            else if (def_.update || !def_.new_folder.empty())
                add_file(job, drawn, picture);
            picture.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
            const std::lock_guard lock(mutex_);
            if (picture.failed() && drawn_++ < def_.most_drawn) picture.drawn = drawn;
            report_progress(def_.on_progress, ++done_, all_);
        }
        {
            const std::lock_guard lock(mutex_);
            job.left -= end - first;
            if (job.left > 0) return;
        }
        job.film.reset();
    }

    /// Compares a picture with its references until one passes. If none does, the result is that of the plain
    /// one.
    Checked judged(const Image& drawn, const Job& job, const Checked& picture) const {
        Checked result = picture;
        result.verdict = Verdict::kMissing;
        result.cause = {.kind = Cause::Kind::kNoReference};
        for (const std::string& path : variants_of(references_, picture.name)) {
            Checked one = compared(drawn, job, def_.settings, path, picture);
            if (one.verdict == Verdict::kPassed) return one;
            if (result.verdict == Verdict::kMissing || fs::path(path).filename() == picture.name)
                result = std::move(one);
        }
        return result;
    }

    /// Encodes a picture that is missing or differs, in an update also one without a record.
    void add_file(const Job& job, const Image& drawn, Checked& picture) {
        const std::string path = (fs::path(def_.folder) / picture.name).string();
        if (picture.verdict == Verdict::kPassed) {
            if (!def_.update || fs::path(picture.reference).filename() != picture.name) return;
            if (provenance_in(read_png_info(path)).golden) return;
            picture.cause = {.kind = Cause::Kind::kLostRecord};
        }
        if (!def_.force && is_no_png(path)) return;
        picture.changed = def_.update;
        if (def_.dry_run) return;
        if (!def_.update) picture.drawn_path = (fs::path(def_.new_folder) / picture.name).string();
        std::string bytes = media::png_bytes(drawn, to_png_info(job.made, *job.film, picture.time_s));
        const std::lock_guard lock(mutex_);
        files_[picture.name] = std::move(bytes);
    }

    const SuiteDef& def_;
    const std::vector<std::string>& references_;
    Files files_;  ///< written when all pictures are drawn
    std::int64_t all_;
    int threads_ = usable_cores();
    std::mutex mutex_;
    std::int64_t done_ = 0;
    int drawn_ = 0;
    TaskQueue queue_;
};

/// Notes the kept pictures whose texts are gone.
void note_lost_records(const SuiteDef& def, const std::vector<Case>& cases, SuiteResult& result) {
    std::vector<std::string> names;
    for (const Case& one : cases)
        for (const Checked& picture : one.pictures)
            if (picture.selected && lacks_record((fs::path(def.folder) / picture.name).string()))
                names.push_back(picture.name);
    if (names.empty()) return;
    result.notes.push_back(fmt::format(
        "{} no record of how it was made, so that a failure cannot say why: {}; run corda golden --update, "
        "and keep the texts of PNG files (a tool such as oxipng --strip removes them)",
        counted(std::ssize(names), "picture") + (names.size() == 1 ? " has" : " have"), listed(names, 3)));
}

/// A reference that no scene asks for.
Checked stale_picture(const SuiteDef& def, const std::string& path) {
    const auto kind = is_no_png(path)      ? Cause::Kind::kUnaskedNoPng
                      : lacks_record(path) ? Cause::Kind::kUnaskedUnrecorded
                                           : Cause::Kind::kUnasked;
    return {.scene = {},
            .name = fs::path(path).filename().string(),
            .verdict = Verdict::kStale,
            .reference = path,
            .cause = {.kind = kind},
            .changed = def.update && (kind == Cause::Kind::kUnasked || def.force)};
}

/// Throws corda::Error (kIo) if there is a folder, a pipe or a device where a picture is to be.
void require_files(const SuiteDef& def, const std::vector<Case>& cases) {
    std::error_code none;
    for (const Case& one : cases)
        for (const Checked& picture : one.pictures)
            if (const auto path = fs::path(def.folder) / picture.name;
                fs::exists(path, none) && !fs::is_regular_file(path, none))
                throw_error(ExitCode::kIo, "'{}' is {}, and a picture needs this name; move it away",
                            path.string(), fs::is_directory(path, none) ? "a folder" : "no file");
}

}  // namespace

SuiteResult run(const SuiteDef& def) {
    SuiteResult result{.may_change = def.update, .dry_run = def.dry_run};
    Suite suite = load_suite(def);
    select(def, suite);
    report_skipped_files(suite, result);
    require_files(def, suite.cases);
    std::erase_if(suite.cases,
                  [](const Case& one) { return std::ranges::none_of(one.pictures, &Checked::selected); });
    std::int64_t all = 0;
    for (const Case& one : suite.cases) all += std::ranges::count_if(one.pictures, &Checked::selected);
    Runner runner(def, suite.references, all);
    runner.check(suite.cases);
    if (!def.new_folder.empty()) write_new(def, suite.cases, runner.files());
    if (!def.update) note_lost_records(def, suite.cases, result);
    for (Case& one : suite.cases)
        std::copy_if(std::make_move_iterator(one.pictures.begin()),
                     std::make_move_iterator(one.pictures.end()), std::back_inserter(result.pictures),
                     [](const Checked& picture) { return picture.selected; });
    std::vector<std::string> removed;
    for (const std::string& path : suite.stale) {
        result.pictures.push_back(stale_picture(def, path));
        if (result.pictures.back().changed) removed.push_back(path);
    }
    std::ranges::move(suite.invalid, std::back_inserter(result.pictures));
    if (def.update && !def.dry_run) publish(def.folder, runner.files(), removed);
    return result;
}

}  // namespace corda::golden
