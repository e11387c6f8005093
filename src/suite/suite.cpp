#include "corda/suite/suite.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <mutex>
#include <set>
#include <thread>

#include "corda/core/file.hpp"
#include "corda/core/text.hpp"
#include "corda/suite/provenance.hpp"

namespace corda::suite {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kEnding = ".png";

struct Case {
    std::string path;
    std::vector<Setting> settings;
    Scene scene;
    std::vector<Checked> pictures;
    std::string frozen;
};

/// Files of a folder with this ending, sorted.
std::vector<std::string> files_in(const std::string& folder, std::string_view ending) {
    std::vector<std::string> paths;
    std::error_code failure;
    for (fs::directory_iterator entry(folder, failure), end; !failure && entry != end;
         entry.increment(failure))
        if (entry->path().extension() == ending) paths.push_back(entry->path().string());
    if (failure) fail_file("read", folder, failure.value());
    std::sort(paths.begin(), paths.end());
    return paths;
}

std::string name_of(const std::string& scene, double time_s) {
    std::string name = fmt::format("{}_t{:011.6f}", scene, time_s);
    std::replace(name.end() - 7, name.end(), '.', '_');
    return name;
}

Case make_case(const std::string& path, const SuiteDef& def, std::set<std::string>& names) {
    Case made{.path = path,
              .settings = def.settings,
              .scene = load_scene(path, def.settings),
              .pictures = {},
              .frozen = {}};
    if (!made.scene.golden) return made;
    made.settings.push_back(
        fmt::format("video.size=[{},{}]", made.scene.golden->width_px, made.scene.golden->height_px));
    made.scene.video.width_px = made.scene.golden->width_px;
    made.scene.video.height_px = made.scene.golden->height_px;
    for (const double time_s : made.scene.golden->at_s) {
        made.pictures.push_back({.scene = made.scene.name,
                                 .name = name_of(made.scene.name, time_s) + std::string(kEnding),
                                 .time_s = time_s});
        if (!names.insert(made.pictures.back().name).second)
            throw Error(ExitCode::kUsage,
                        fmt::format("two pictures would both be {}; rename '{}', or give times that differ "
                                    "by 1e-6 s or more",
                                    made.pictures.back().name, path));
    }
    return made;
}

std::vector<Case> load_cases(const SuiteDef& def) {
    std::vector<Case> cases;
    std::set<std::string> names;
    for (const std::string& path : def.paths) {
        const bool is_folder = fs::is_directory(path);
        const std::vector<std::string> files = is_folder ? files_in(path, ".toml") : std::vector{path};
        for (const std::string& file : files) {
            Case made = make_case(file, def, names);
            if (made.scene.golden)
                cases.push_back(std::move(made));
            else if (!is_folder)
                throw Error(ExitCode::kUsage, fmt::format("'{}' has no table [golden]; add one, for instance "
                                                          "[golden] with at = [0.0, 1.0]",
                                                          file));
        }
    }
    if (cases.empty())
        throw Error(ExitCode::kUsage,
                    fmt::format("no scene in '{}' has a table [golden]; add one, for instance [golden] with "
                                "at = [0.0, 1.0]",
                                def.paths.front()));
    return cases;
}

/// NAME.png and every NAME.CAUSE.png that there is.
std::vector<std::string> variants_of(const std::vector<std::string>& references, const std::string& name) {
    const std::string stem = name.substr(0, name.size() - kEnding.size()) + ".";
    std::vector<std::string> variants;
    for (const std::string& path : references)
        if (fs::path(path).filename().string().starts_with(stem)) variants.push_back(path);
    return variants;
}

/// Compares a picture with its references until one matches; otherwise tells of the plain one, if there is.
void judge(const Image& drawn, const Provenance& now, const GoldenDef& golden,
           const std::vector<std::string>& variants, Checked& picture) {
    const DifferenceLimits limits{.max = golden.max, .mean = {}, .share = golden.share};
    picture.verdict = variants.empty() ? Verdict::kMissing : Verdict::kDifferent;
    for (const std::string& path : variants) {
        const std::string file = fs::path(path).filename().string();
        const Image reference = read_png(path);
        const Difference difference = compare(reference, drawn);
        const bool passes = difference.within(limits);
        if (!passes && !picture.variant.empty() && file != picture.name) continue;
        picture.difference = difference;
        picture.variant = file;
        picture.cause = passes ? "" : cause_of(from_png_info(read_png_info(path)), now);
        if (!passes && !difference.same_size)
            picture.cause = fmt::format("{}x{} pixels, now {}x{}", reference.width(), reference.height(),
                                        drawn.width(), drawn.height());
        if (passes) picture.verdict = Verdict::kPassed;
        if (passes) return;
    }
}

class Runner {
  public:
    Runner(const SuiteDef& def, std::vector<std::string> references, std::int64_t all)
        : def_(def), references_(std::move(references)), all_(all) {}

    void check(Case& one) {
        const std::vector<Setting> frozen = frozen_settings(one);
        const Film film = film_of(one, frozen);
        for (Checked& picture : one.pictures) {
            const Image drawn = film.still(picture.time_s);
            const bool is_empty = film.shows_nothing();
            judge(drawn, provenance_of(film, picture.time_s), *one.scene.golden,
                  variants_of(references_, picture.name), picture);
            if (is_empty) picture.verdict = Verdict::kEmpty;
            if (is_empty) picture.cause = "the picture is empty: nothing is in view";
            count_one();
        }
        tell_since_when(one);
        if (def_.update) update(one, frozen);
    }

  private:
    /// What the references of a scene freeze; from the first that says it.
    std::vector<Setting> frozen_settings(Case& one) {
        for (const Checked& picture : one.pictures) {
            for (const std::string& path : variants_of(references_, picture.name)) {
                const auto frozen = freezing(one.scene, from_png_info(read_png_info(path)));
                if (frozen.empty()) continue;
                one.frozen = fmt::format("{}: frozen by {}:", one.scene.name, picture.name);
                for (const Setting& setting : frozen) one.frozen += " " + setting;
                return frozen;
            }
        }
        return {};
    }

    /// The film of a scene with what is frozen, if that still fits it.
    [[nodiscard]] Film film_of(Case& one, const std::vector<Setting>& frozen) const {
        std::vector<Setting> settings = one.settings;
        settings.insert(settings.end(), frozen.begin(), frozen.end());
        FilmDef def = def_.film;
        def.stills_s = one.scene.golden->at_s;
        try {
            return Film(load_scene(one.path, settings), def);
        } catch (const Error& error) {
            if (frozen.empty() || error.code() != ExitCode::kInvalidScene) throw;
            one.frozen =
                fmt::format("{}: what its references freeze does not fit the scene any more", one.scene.name);
            return Film(load_scene(one.path, one.settings), def);
        }
    }

    /// Adds to the causes from when on positions differ.
    static void tell_since_when(Case& one) {
        const auto moved = [](const Checked& picture) { return picture.cause.starts_with("positions"); };
        const auto first = std::find_if(one.pictures.begin(), one.pictures.end(), moved);
        for (auto picture = first; picture != one.pictures.end(); ++picture)
            if (moved(*picture)) picture->cause += fmt::format(", from t = {} s on", first->time_s);
    }

    /// Writes what is missing; if a picture differs, all of the scene anew, with nothing frozen, so that they
    /// have one solver and one camera.
    void update(Case& one, const std::vector<Setting>& frozen) const {
        const auto has = [&](Verdict verdict) {
            return std::any_of(one.pictures.begin(), one.pictures.end(),
                               [&](const Checked& picture) { return picture.verdict == verdict; });
        };
        const bool anew = has(Verdict::kDifferent);
        if (!anew && !has(Verdict::kMissing)) return;
        const Film film = film_of(one, anew ? std::vector<Setting>{} : frozen);
        for (Checked& picture : one.pictures) {
            if (!anew && picture.verdict != Verdict::kMissing) continue;
            const Image drawn = film.still(picture.time_s);
            if (film.shows_nothing()) continue;
            picture.changed = true;
            picture.verdict = Verdict::kPassed;
            if (def_.dry_run) continue;
            write_png(
                (fs::path(def_.folder) / picture.name).string(), drawn,
                to_png_info(provenance_of(film, picture.time_s), printable(one.scene.name), picture.time_s),
                {.force = true});
        }
    }

    void count_one() {
        const std::lock_guard lock(mutex_);
        report_progress(def_.on_progress, ++done_, all_);
    }

    const SuiteDef& def_;
    std::vector<std::string> references_;
    std::int64_t all_;
    std::int64_t done_ = 0;
    std::mutex mutex_;
};

/// Runs the scenes on as many threads as there are cores; throws what the first scene that failed threw.
void check_all(Runner& runner, std::vector<Case>& cases) {
    std::atomic<std::size_t> next = 0;
    std::atomic<bool> failed = false;
    std::vector<std::exception_ptr> errors(cases.size());
    const auto work = [&] {
        for (std::size_t i = next++; i < cases.size() && !failed; i = next++) {
            try {
                runner.check(cases[i]);
            } catch (...) {
                errors[i] = std::current_exception();
                failed = true;
            }
        }
    };
    {
        std::vector<std::jthread> threads;
        const std::size_t cores = std::max(1U, std::thread::hardware_concurrency());
        for (std::size_t i = 0; i < std::min(cores, cases.size()); ++i) threads.emplace_back(work);
    }
    for (const std::exception_ptr& error : errors)
        if (error) std::rethrow_exception(error);
}

/// Whether a file is called NAME_tSSSS_SSSSSS[.CAUSE].png; `scene` becomes NAME.
bool is_golden_name(const std::string& file, std::string& scene) {
    constexpr std::size_t kTimeDigits = 11;
    const std::string stem = file.substr(0, file.size() - kEnding.size());
    const std::size_t mark = stem.rfind("_t");
    if (mark == std::string::npos) return false;
    const std::string time = stem.substr(mark + 2, stem.find('.', mark) - mark - 2);
    scene = stem.substr(0, mark);
    return time.size() >= kTimeDigits && time.find_first_not_of("0123456789_") == std::string::npos;
}

/// References that no scene asks for; if scenes are named one by one, of these alone.
std::vector<std::string> stale_ones(const SuiteDef& def, const std::vector<Case>& cases,
                                    const std::vector<std::string>& references) {
    std::set<std::string> used;
    std::set<std::string> scenes;
    for (const Case& one : cases) {
        scenes.insert(one.scene.name);
        for (const Checked& picture : one.pictures)
            for (const std::string& path : variants_of(references, picture.name)) used.insert(path);
    }
    const bool has_folder = std::any_of(def.paths.begin(), def.paths.end(),
                                        [](const std::string& path) { return fs::is_directory(path); });
    std::vector<std::string> stale;
    for (const std::string& path : references) {
        std::string scene;
        if (used.contains(path) || !is_golden_name(fs::path(path).filename().string(), scene)) continue;
        if (has_folder || scenes.contains(scene)) stale.push_back(path);
    }
    return stale;
}

}  // namespace

std::int64_t SuiteResult::count(Verdict verdict) const {
    return std::count_if(pictures.begin(), pictures.end(),
                         [&](const Checked& picture) { return picture.verdict == verdict; });
}

SuiteResult run(const SuiteDef& def) {
    std::vector<Case> cases = load_cases(def);
    if (def.update && !def.dry_run) make_folder(def.folder);
    const bool exists = fs::exists(def.folder);
    if (!exists && !def.update)
        throw Error(ExitCode::kIo,
                    fmt::format("there is no folder '{}'; --update makes it and its pictures", def.folder));
    const auto references = exists ? files_in(def.folder, kEnding) : std::vector<std::string>{};
    std::int64_t all = 0;
    for (const Case& one : cases) all += std::ssize(one.pictures);
    Runner runner(def, references, all);
    check_all(runner, cases);
    SuiteResult result;
    for (const Case& one : cases) {
        result.pictures.insert(result.pictures.end(), one.pictures.begin(), one.pictures.end());
        if (!one.frozen.empty()) result.frozen.push_back(one.frozen);
    }
    for (const std::string& path : stale_ones(def, cases, references)) {
        if (def.update && !def.dry_run && !fs::remove(path)) fail_file("remove", path, ENOENT);
        result.pictures.push_back({.scene = {},
                                   .name = fs::path(path).filename().string(),
                                   .verdict = Verdict::kStale,
                                   .cause = "no scene asks for it",
                                   .changed = def.update});
    }
    return result;
}

}  // namespace corda::suite
