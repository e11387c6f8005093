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

/// State that the threads of a run share.
struct Run {
    const SuiteDef& def;
    const std::vector<std::string>& references;
    std::int64_t all;  ///< pictures to draw
    int threads = usable_cores();
    TaskQueue queue{};
    std::mutex mutex{};  ///< of all below
    std::int64_t done = 0;
    int kept = 0;   ///< see SuiteDef::most_drawn
    Files files{};  ///< of an update, or for SuiteDef::new_folder; written when all pictures are drawn
};

/// A scene that is being drawn.
struct Job {
    Case& scene;
    Film film;
    GoldenRecord made;
};

/// A picture as it compares with one of its references. `settings`: of the suite.
Checked compared(const Image& drawn, const Job& job, const std::vector<Setting>& settings,
                 const std::string& path, Checked picture) {
    const Scene& scene = job.film.scene();
    const Image* const mask = job.scene.mask ? &*job.scene.mask : nullptr;
    picture.reference = path;
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
    if (!difference.within(
            {.max = scene.golden->max, .mean = scene.golden->mean, .share = scene.golden->share}))
        picture.cause = cause_of(provenance_in(read_png_info(path)), job.made, scene, settings);
    return picture;
}

/// Compares a picture with its references until one passes. If none does, the result is that of the plain
/// one.
Checked judged(const Run& run, const Image& drawn, const Job& job, const Checked& picture) {
    Checked result = picture;
    result.cause = {.kind = Cause::Kind::kNoReference};
    for (const std::string& path : variants_of(run.references, picture.name)) {
        Checked one = compared(drawn, job, run.def.settings, path, picture);
        if (!one.failed()) return one;
        if (result.reference.empty() || fs::path(path).filename() == picture.name) result = std::move(one);
    }
    return result;
}

/// Encodes a picture that is missing or differs, in an update also one without a record.
void add_file(Run& run, const Job& job, const Image& drawn, Checked& picture) {
    const SuiteDef& def = run.def;
    const std::string path = (fs::path(def.folder) / picture.name).string();
    if (!picture.failed()) {
        if (!def.update || fs::path(picture.reference).filename() != picture.name) return;
        if (provenance_in(read_png_info(path)).golden) return;
        picture.cause = {.kind = Cause::Kind::kLostRecord};
    }
    if (!def.force && is_no_png(path)) return;
    picture.changed = def.update;
    if (def.dry_run) return;
    if (!def.update) picture.drawn_path = (fs::path(def.new_folder) / picture.name).string();
    std::string bytes = media::png_bytes(drawn, to_png_info(job.made, job.film, picture.time_s));
    const std::lock_guard lock(run.mutex);
    run.files[picture.name] = std::move(bytes);
}

/// Draws and judges the pictures first <= i < end of a scene.
void draw(Run& run, const Job& job, std::size_t first, std::size_t end) {
    const SuiteDef& def = run.def;
    const render::CanvasUse canvas(job.film.context_def());
    for (std::size_t i = first; i < end; ++i) {
        Checked& picture = job.scene.pictures[i];
        if (!picture.selected) continue;
        const auto start = std::chrono::steady_clock::now();
        const double shutter = job.film.scene().video.shutter;
        const bool is_empty =
            film::paint(job.film.look(), job.film.motion(), picture.time_s, shutter, *canvas).is_empty;
        const Image& drawn = canvas->image();
        picture = judged(run, drawn, job, picture);
        picture.is_empty = is_empty || has_one_color(drawn);
        if (!picture.is_empty && (def.update || !def.new_folder.empty())) add_file(run, job, drawn, picture);
        picture.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        const std::lock_guard lock(run.mutex);
        if (picture.failed() && run.kept++ < def.most_drawn) picture.drawn = drawn;
        report_progress(def.on_progress, ++run.done, run.all);
    }
}

/// Makes the film of a scene, and tasks of its pictures. The last of these ends the film.
void begin(Run& run, Case& one) {
    const Scene scene = one.drawn();
    FilmDef def = run.def.film;
    def.stills_s = scene.golden->at_s;
    def.stills_shutter = scene.video.shutter;
    const Film film(scene, def);
    const auto job = std::make_shared<const Job>(Job{one, film, record_of(film)});
    const std::size_t count = one.pictures.size();
    const auto pieces = std::clamp<std::size_t>(count / kMinApart, 1, static_cast<std::size_t>(run.threads));
    for (std::size_t i = 0; i < pieces; ++i)
        run.queue.push_front([&run, job, first = count * i / pieces, end = count * (i + 1) / pieces] {
            draw(run, *job, first, end);
        });
}

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
    Run run{def, suite.references, all};
    report_progress(def.on_progress, 0, all);
    for (Case& one : suite.cases) run.queue.push_back([&run, &one] { begin(run, one); });
    run.queue.run(run.threads);
    if (!def.new_folder.empty()) write_new(def, suite.cases, run.files);
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
    if (def.update && !def.dry_run) publish(def.folder, run.files, removed);
    return result;
}

}  // namespace corda::golden
