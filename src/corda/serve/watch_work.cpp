// The thread of a watch.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <exception>
#include <new>
#include <numbers>
#include <utility>

#include "corda/core/cancel.hpp"
#include "corda/film/motion.hpp"
#include "corda/film/plan_text.hpp"
#include "corda/film/series.hpp"
#include "corda/media/bytes.hpp"
#include "corda/serve/smaller.hpp"
#include "corda/serve/watch_state.hpp"

namespace corda::serve {

using Json = nlohmann::json;
using Clock = std::chrono::steady_clock;

std::shared_ptr<ShownFilm> next_film(WatchState& state, const Film& film, const Json& words) {
    const std::int64_t playhead = state.film ? state.film->pictures.playhead() : 0;
    VideoDef small = film.scene().video;
    small.scale_to(std::min(state.side_px, std::max(small.width_px, small.height_px)));
    auto next = std::make_shared<ShownFilm>(ShownFilm{++state.films,
                                                      film,
                                                      words,
                                                      {film.frame_count(), state.def.picture_bytes, playhead},
                                                      small.width_px,
                                                      small.height_px});
    next->words.update({{"number", state.films}, {"width", small.width_px}, {"height", small.height_px}});
    return next;
}

namespace {

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
        const Image image = shown.film.frame(k);
        const bool is_whole = image.width() == shown.width_px && image.height() == shown.height_px;
        picture.png =
            media::png_bytes(is_whole ? image : made_smaller(image, shown.width_px, shown.height_px), {});
    } catch (const Error& error) {
        if (is_interruption(error.code())) throw;
        picture.error = error.what();
    } catch (const std::bad_alloc&) {
        picture.error = "out of memory; a smaller size may help";
    }
    update(state, [&] { shown.pictures.keep(k, std::move(picture)); });
}

/// Draws the frame of a film at the playhead, and shows the film.
void show(WatchState& state, const Film& film) {
    const VideoDef& video = film.scene().video;
    const Json words = {{"name", film.scene().name},
                        {"frames", film.frame_count()},
                        {"fps", video.fps.per_second()},
                        {"frame_s", video.scene_rate().interval_s()},
                        {"full", {video.width_px, video.height_px}},
                        {"plan", plan_lines(film)}};
    std::shared_ptr<ShownFilm> next;
    int side_px = 0;
    update(state, [&] {
        next = next_film(state, film, words);
        side_px = state.side_px;
    });
    draw(state, *next, next->pictures.playhead());
    bool was_wrong = false;
    update(state, [&] { was_wrong = !state.problems.empty(); });
    if (was_wrong && state.def.on_problems) state.def.on_problems({});
    update(state, [&] {
        state.film = side_px == state.side_px ? next : next_film(state, film, words);
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
    const Scene scene = parse_scene(text, def.path, def.settings, {"slider", settings_of(changes, numbers)});
    def.film.readings.velocities = true;
    def.film.on_progress = progress_of(state);
    const Film film(scene, def.film);
    static_cast<void>(film.state(film.frame_count() - 1));  // a motion that diverges is an error
    static_cast<void>(film.gl());                           // so is a driver that cannot draw it
    show(state, film);
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

}  // namespace

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

}  // namespace corda::serve
