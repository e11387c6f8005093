#include "corda/serve/watch.hpp"

#include <fmt/format.h>
#include <poll.h>
#include <sys/inotify.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <exception>
#include <filesystem>
#include <mutex>
#include <new>
#include <numbers>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>

#include <nlohmann/json.hpp>

#include "corda/core/cancel.hpp"
#include "corda/core/output_file.hpp"
#include "corda/core/text.hpp"
#include "corda/film/motion.hpp"
#include "corda/film/plan_text.hpp"
#include "corda/film/series.hpp"
#include "corda/media/bytes.hpp"
#include "corda/scene/scene.hpp"
#include "corda/serve/picture_queue.hpp"
#include "corda/serve/scene_numbers.hpp"
#include "embedded_page.hpp"

namespace corda::serve {

using Json = nlohmann::json;
using Clock = std::chrono::steady_clock;

/// A film as requests see it. A film that takes its place is another object.
struct ShownFilm {
    std::int64_t number;
    Film film;
    Json words;  ///< what the page says of it
    PictureQueue pictures;
    bool are_curves_wanted = false;
    std::optional<std::string> curves = {};
};

/// State that the thread of a watch shares with the threads of requests.
struct WatchState {
    explicit WatchState(WatchDef its) : def(std::move(its)) {}

    std::mutex mutex;  ///< of all below
    std::condition_variable changed;
    WatchDef def;
    bool is_ending = false;
    bool is_reload_asked = true;
    std::int64_t version = 1;  ///< of all below
    bool is_busy = true;       ///< the scene is being loaded and simulated
    double progress = 0.0;     ///< of that, 0 .. 1
    std::vector<Problem> problems;
    std::string text;  ///< of the file as it was loaded last
    std::vector<SceneNumber> numbers;
    NumberChanges changes;
    std::int64_t films = 0;           ///< number of films so far
    std::shared_ptr<ShownFilm> film;  ///< the last good one; null before the first
};

namespace {

constexpr auto kLongestWait = std::chrono::seconds(20);
constexpr int kMinSidePx = 160;

/// A problem as the page shows it, which need not name the file at `path`.
Json json_of(Problem problem, const std::string& path) {
    Json json = {{"line", nullptr},
                 {"column", nullptr},
                 {"key", printable(problem.place.key)},
                 {"value", printable(problem.value)}};
    if (problem.place.source == path) {
        if (problem.place.line > 0)
            json.update({{"line", problem.place.line}, {"column", problem.place.column}});
        problem.place = {.source = {}, .key = problem.place.key};
    }
    json["text"] = printable_lines(problem.text());
    return json;
}

Json json_of(const SceneNumber& number, const NumberChanges& changes) {
    const auto change = changes.find(number.key);
    return {{"key", number.key},         {"value", change == changes.end() ? number.value : change->second},
            {"unchanged", number.value}, {"is_integer", number.is_integer},
            {"low", number.low},         {"high", number.high},
            {"unit", number.unit},       {"meaning", number.meaning},
            {"line", number.line}};
}

std::vector<std::string> plan_lines(const Film& film) {
    std::vector<std::string> lines{system_text(film.system()),
                                   "method: " + plan_text(film.system(), film.plan())};
    if (const auto estimate = error_estimate_text(film)) lines.push_back("error estimate " + *estimate);
    if (film.plan().horizon_s) lines.push_back(fmt::format("horizon {:.6g} s", *film.plan().horizon_s));
    for (const std::string& note : film.plan().notes) lines.push_back(note);
    for (const std::string& term : modelled_terms(film.scene(), film.plan()))
        lines.push_back("modelled: " + term);
    return lines;
}

/// -1 for a text that is no number.
std::int64_t number_of(std::string_view text) {
    return whole_number<std::int64_t>(text).value_or(-1);
}

std::int64_t number_in(const Request& request, std::string_view name) {
    const auto found = request.query.find(name);
    return found == request.query.end() ? 0 : number_of(found->second);
}

/// Calls `change` under the lock, and wakes who waits.
template <class Change>
void update(WatchState& state, const Change& change) {
    {
        const std::lock_guard lock(state.mutex);
        change();
    }
    state.changed.notify_all();
}

// The thread of a watch.

OnProgress progress_of(WatchState& state) {
    return [&state, shown = Clock::now()](std::int64_t done, std::int64_t total) mutable {
        constexpr auto kSilent = std::chrono::milliseconds(300);
        if (const auto now = Clock::now(); now - shown > kSilent) {
            shown = now;
            update(state, [&] {
                state.progress = total > 0 ? static_cast<double>(done) / static_cast<double>(total) : 0.0;
                ++state.version;
            });
        }
        return true;
    };
}

void draw(WatchState& state, ShownFilm& shown, std::int64_t k) {
    Picture picture;
    try {
        picture.png = media::png_bytes(shown.film.frame(k), {});
    } catch (const Error& error) {
        if (is_interruption(error.code())) throw;
        picture.error = error.what();
    } catch (const std::bad_alloc&) {
        picture.error = "out of memory; a smaller size may help";
    }
    update(state, [&] { shown.pictures.keep(k, std::move(picture)); });
}

/// Puts a film in the place of the last one, and draws the frame that is shown.
void show(WatchState& state, const Film& film, const Json& full_px) {
    const VideoDef& video = film.scene().video;
    const Rational fps = video.fps.rational();
    Json words = {{"name", film.scene().name},
                  {"frames", film.frame_count()},
                  {"fps", static_cast<double>(fps.num) / static_cast<double>(fps.den)},
                  {"frame_s", film.scene().video.scene_rate().interval_s()},
                  {"width", video.width_px},
                  {"height", video.height_px},
                  {"full", full_px},
                  {"plan", plan_lines(film)}};
    std::shared_ptr<ShownFilm> shown;
    std::int64_t first = 0;
    update(state, [&] {
        const std::int64_t playhead = state.film ? state.film->pictures.playhead() : 0;
        words["number"] = ++state.films;
        shown = state.film = std::make_shared<ShownFilm>(
            ShownFilm{state.films, film, words, {film.frame_count(), state.def.picture_bytes, playhead}});
        first = shown->pictures.playhead();
    });
    draw(state, *shown, first);  // before the page asks for it
    update(state, [&] {
        state.problems.clear();
        state.is_busy = false;
        ++state.version;
    });
}

void load(WatchState& state) {
    WatchDef def;
    NumberChanges changes;
    update(state, [&] {
        state.is_busy = true;
        state.progress = 0.0;
        ++state.version;
        def = state.def;
        changes = state.changes;
    });
    const std::string text = scene::read_file(def.path);
    const std::vector<SceneNumber> numbers = numbers_of(text, def.path, def.settings);
    update(state, [&] {
        state.text = text;
        state.numbers = numbers;
        std::erase_if(state.changes, [&](const auto& change) {  // of a number that the file has no more
            return std::ranges::find(numbers, change.first, &SceneNumber::key) == numbers.end();
        });
    });
    Scene scene = parse_scene(text, def.path, def.settings, {"slider", settings_of(changes, numbers)});
    const auto [width_px, height_px] = std::pair(scene.video.width_px, scene.video.height_px);
    scene.video.scale_to(std::min(def.longest_side_px, std::max(width_px, height_px)));
    def.film.readings.velocities = true;
    def.film.on_progress = progress_of(state);
    const Film film(scene, def.film);
    static_cast<void>(film.state(film.frame_count() - 1));  // a motion that diverges is an error
    static_cast<void>(film.gl());                           // so is a driver that cannot draw it
    show(state, film, {width_px, height_px});
}

void read_curves(WatchState& state, ShownFilm& shown) {
    constexpr std::int64_t kMaxPoints = 1200;
    const Film& film = shown.film;
    const auto tracked = film::tracked_particles(film.system(), 1);
    const film::SeriesSource source(film.motion());
    std::vector<double> times_s;
    for (std::int64_t k = 0; k < film.frame_count(); k += 1 + (film.frame_count() - 1) / kMaxPoints)
        times_s.push_back(film.time_s(k));
    Json curves = {{"angle_deg", Json::array()}};
    film.motion().for_each(times_s, [&](const State& now, const Figures& figures) {
        check_cancelled();
        const film::Instant instant(source, now, figures);
        if (!tracked.empty() && tracked.front().pin)
            curves["angle_deg"].push_back(film::turning_of(tracked.front(), now, nullptr).x * 180.0 /
                                          std::numbers::pi);
        for (const film::Series& one : {film::kSeries.time, film::kSeries.kinetic, film::kSeries.potential})
            curves[one.key].push_back(one.value(instant));
    });
    update(state, [&] {
        shown.curves = curves.dump();
        shown.are_curves_wanted = false;
    });
}

void fail(WatchState& state, const std::vector<Problem>& problems) {
    update(state, [&] {
        state.problems = problems;
        state.is_busy = false;
        if (state.film) state.film->are_curves_wanted = false;
        ++state.version;
    });
    if (state.def.on_problems) state.def.on_problems(problems);
}

/// The next work of the thread.
struct Job {
    bool is_end = false;
    bool is_load = false;
    std::shared_ptr<ShownFilm> film = {};
    std::optional<std::int64_t> frame = {};  ///< to draw; none: the curves are read
};

Job wait_for_job(WatchState& state) {
    std::unique_lock lock(state.mutex);
    Job job;
    state.changed.wait(lock, [&] {
        job.film = state.is_busy ? nullptr : state.film;
        job.frame = job.film ? job.film->pictures.next() : std::nullopt;
        return state.is_ending || state.is_reload_asked || job.frame ||
               (job.film && job.film->are_curves_wanted);
    });
    job.is_end = state.is_ending;
    job.is_load = std::exchange(state.is_reload_asked, false);
    if (job.film && job.film->are_curves_wanted && job.frame && !job.film->pictures.is_awaited(*job.frame))
        job.frame.reset();
    return job;
}

void work(WatchState& state) {
    const CancelScope scope([&state] {
        const std::lock_guard lock(state.mutex);
        return !state.is_ending && !state.is_reload_asked;
    });
    for (Job job = wait_for_job(state); !job.is_end; job = wait_for_job(state)) {
        try {
            if (job.is_load)
                load(state);
            else if (job.frame)
                draw(state, *job.film, *job.frame);
            else
                read_curves(state, *job.film);
        } catch (const Error& error) {
            if (!is_interruption(error.code())) fail(state, error.problems());
        } catch (const std::bad_alloc&) {
            fail(state, {{{}, "out of memory", "a smaller scene may help"}});
        } catch (const std::exception& error) {
            fail(state, {{{}, error.what(), {}}});
        }
    }
}

// The threads of requests.

void ask_for_reload(WatchState& state) {
    update(state, [&] { state.is_reload_asked = true; });
}

Response state_after(WatchState& state, std::int64_t version) {
    std::unique_lock lock(state.mutex);
    state.changed.wait_for(lock, kLongestWait, [&] { return state.is_ending || state.version != version; });
    Json problems = Json::array();
    for (const Problem& problem : state.problems) problems.push_back(json_of(problem, state.def.path));
    Json numbers = Json::array();
    for (const SceneNumber& number : state.numbers) numbers.push_back(json_of(number, state.changes));
    return {200, "application/json",
            Json{{"version", state.version},
                 {"busy", state.is_busy},
                 {"progress", state.progress},
                 {"ended", state.is_ending},
                 {"file", state.def.path},
                 {"film", state.film ? state.film->words : Json()},
                 {"problems", problems},
                 {"numbers", numbers},
                 {"changes", state.changes.size()}}
                .dump(-1, ' ', false, Json::error_handler_t::replace)};
}

Response frame(WatchState& state, std::int64_t k, std::int64_t number) {
    const auto is_gone = [] { return text_response(410, "this frame is not in the present film\n"); };
    std::unique_lock lock(state.mutex);
    const std::shared_ptr<ShownFilm> film = state.film;
    if (!film || film->number != number || k < 0 || k >= film->pictures.frames()) return is_gone();
    film->pictures.await(k);
    state.changed.notify_all();
    state.changed.wait_for(lock, kLongestWait, [&] {
        return state.is_ending || state.film != film || film->pictures.find(k) != nullptr;
    });
    film->pictures.leave(k);
    if (state.film != film) return is_gone();
    const Picture* const picture = film->pictures.find(k);
    if (picture == nullptr) return text_response(503, "this frame is not drawn yet; ask again\n");
    if (!picture->error.empty()) return text_response(422, picture->error);
    return {200, "image/png", picture->png};
}

Response curves(WatchState& state, std::int64_t number) {
    std::unique_lock lock(state.mutex);
    const std::shared_ptr<ShownFilm> film = state.film;
    if (!film || film->number != number)
        return text_response(410, "these curves are not of the present film\n");
    if (!film->curves) film->are_curves_wanted = true;
    state.changed.notify_all();
    state.changed.wait_for(lock, kLongestWait, [&] {
        return state.is_ending || state.film != film || film->curves || !film->are_curves_wanted;
    });
    if (state.film != film || !(film->curves || film->are_curves_wanted))
        return text_response(410, "there are no curves\n");
    if (!film->curves) return text_response(503, "the curves are not read yet; ask again\n");
    return {200, "application/json", *film->curves};
}

Response change_number(WatchState& state, const Json& body) {
    {
        const std::lock_guard lock(state.mutex);
        const auto number = std::ranges::find_if(state.numbers, [&](const SceneNumber& candidate) {
            return body.contains("key") && body["key"] == candidate.key;
        });
        const Json value = body.value("value", Json());
        if (number == state.numbers.end()) return text_response(400, "the scene has no such number\n");
        if (value.is_number() && value.get<double>() != number->value)
            state.changes[number->key] = value.get<double>();
        else
            state.changes.erase(number->key);
    }
    ask_for_reload(state);
    return {};
}

Response write_file(WatchState& state) {
    std::string path;
    std::string text;
    NumberChanges changes;
    {
        const std::lock_guard lock(state.mutex);
        if (state.is_busy || state.is_reload_asked || !state.problems.empty())
            return text_response(409,
                                 "numbers are written once the scene with them is shown without errors\n");
        path = state.def.path;
        text = state.text;
        changes = state.changes;
    }
    if (scene::read_file(path) != text)
        return text_response(409, "the file has changed; look at its new state, and write again\n");
    save_file(path, with_changes(text, path, changes));
    {
        const std::lock_guard lock(state.mutex);
        // What has changed since stays a change, and a number in the file counts again in place of --set.
        for (const auto& [key, value] : changes) {
            if (const auto now = state.changes.find(key); now != state.changes.end() && now->second == value)
                state.changes.erase(now);
            for (SceneNumber& number : state.numbers)
                if (number.key == key) number.value = value;
            std::erase_if(state.def.settings,
                          [&changed = key](const Setting& setting) { return sets(setting, changed); });
        }
    }
    ask_for_reload(state);
    return {};
}

Response answer_post(WatchState& state, const Request& request) {
    const Json body = Json::parse(request.body, nullptr, false);
    if (request.path == "number" && body.is_object()) return change_number(state, body);
    if (request.path == "write") return write_file(state);
    if (request.path != "side" || !body.is_object() || !body.value("px", Json()).is_number_integer())
        return text_response(400, "no such request\n");
    const int side_px = std::clamp(body["px"].get<int>(), kMinSidePx, kMaxSidePx);
    update(state, [&] { state.def.longest_side_px = side_px; });
    ask_for_reload(state);
    return {};
}

}  // namespace

Watch::Watch(WatchDef def) : state_(std::make_unique<WatchState>(std::move(def))) {
    thread_ = std::jthread([this] { work(*state_); });
}

Watch::~Watch() {
    end();
    thread_.join();
}

void Watch::end() {
    update(*state_, [this] { state_->is_ending = true; });
}

void Watch::reload() {
    ask_for_reload(*state_);
}

Response Watch::answer(const Request& request) {
    if (request.is_post) return answer_post(*state_, request);
    if (request.path.empty()) return page_response("text/html", kWatchHtml);
    if (request.path == "style.css") return page_response("text/css", kStyleCss);
    if (request.path == "watch.js") return page_response("text/javascript", kWatchJs);
    if (request.path == "state") return state_after(*state_, number_in(request, "after"));
    if (request.path == "curves") return curves(*state_, number_in(request, "film"));
    const std::string_view path = request.path;
    constexpr std::string_view kFrame = "frame/";
    constexpr std::string_view kPng = ".png";
    if (path.starts_with(kFrame) && path.ends_with(kPng))
        return frame(*state_,
                     number_of(path.substr(kFrame.size(), path.size() - kFrame.size() - kPng.size())),
                     number_in(request, "film"));
    return text_response(404, "there is no such page\n");
}

FileWatch::FileWatch(const std::string& path)
    : path_(path), inotify_(::inotify_init1(IN_CLOEXEC | IN_NONBLOCK)), last_(stamp()) {
    // The folder is watched, because many editors put a new file in the place of the old one.
    const std::filesystem::path folder = std::filesystem::path(path).parent_path();
    constexpr unsigned kEvents = IN_CLOSE_WRITE | IN_MOVED_TO | IN_DELETE;
    if (inotify_ && ::inotify_add_watch(inotify_.get(), folder.empty() ? "." : folder.c_str(), kEvents) >= 0)
        return;
    const int reason = errno;
    if (reason != EMFILE && reason != ENFILE && reason != ENOSPC) fail_file("watch", path, reason);
    throw_error(ExitCode::kTemporary,
                "cannot watch '{}': {}; raise fs.inotify.max_user_instances and fs.inotify.max_user_watches",
                path, std::generic_category().message(reason));
}

bool FileWatch::wait(int timeout_ms) {
    pollfd events{inotify_.get(), POLLIN, 0};
    static_cast<void>(::poll(&events, 1, timeout_ms));
    alignas(inotify_event) std::array<char, 4096> ignored{};
    while (::read(inotify_.get(), ignored.data(), ignored.size()) > 0) continue;
    const Stamp now = stamp();
    return std::exchange(last_, now) != now;
}

FileWatch::Stamp FileWatch::stamp() const {
    struct ::stat info {};
    if (::stat(path_.c_str(), &info) != 0) return {};
    return {info.st_mtim.tv_sec, info.st_mtim.tv_nsec, info.st_size, info.st_ino};
}

}  // namespace corda::serve
