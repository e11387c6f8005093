#include "corda/serve/watch.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <exception>
#include <new>
#include <numbers>
#include <string_view>
#include <utility>

#include "corda/core/cancel.hpp"
#include "corda/core/output_file.hpp"
#include "corda/core/text.hpp"
#include "corda/film/plan_text.hpp"
#include "corda/film/tracked_particle.hpp"
#include "corda/media/bytes.hpp"
#include "corda/scene/document.hpp"
#include "corda/scene/scene.hpp"
#include "embedded_page.hpp"

namespace corda::serve {
namespace {

using Json = nlohmann::json;
using Clock = std::chrono::steady_clock;

constexpr auto kLongestWait = std::chrono::seconds(20);
constexpr int kMinSidePx = 160;

/// A problem as the page shows it, which need not name the file at `path`.
Json json_of(Problem problem, const std::string& path) {
    Json json = {{"line", nullptr}, {"column", nullptr}};
    if (problem.place.source == path) {
        if (problem.place.line > 0) json = {{"line", problem.place.line}, {"column", problem.place.column}};
        problem.place = {.source = {}, .key = problem.place.key};
    }
    json["text"] = printable_lines(problem.text());
    return json;
}

/// True if a setting gives the value of this key, or of a table or list that the key lies in.
bool sets(const Setting& setting, const std::string& key) {
    const auto inner = scene::parse_key(key);
    const auto outer = scene::parse_key(std::string_view(setting).substr(0, setting.find('=')));
    return inner && outer && outer->size() <= inner->size() &&
           std::equal(outer->begin(), outer->end(), inner->begin());
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
    if (film.plan().horizon_s)
        lines.push_back(fmt::format("predictability ends at {:.6g} s", *film.plan().horizon_s));
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

}  // namespace

Watch::Watch(WatchDef def) : def_(std::move(def)) {
    thread_ = std::jthread([this] { work(); });
}

Watch::~Watch() {
    end();
    thread_.join();
}

template <class Change>
void Watch::update(const Change& change) {
    {
        const std::lock_guard lock(mutex_);
        change();
    }
    changed_.notify_all();
}

void Watch::end() {
    update([this] { is_ending_ = true; });
}

void Watch::reload() {
    update([this] { is_reload_asked_ = true; });
}

bool Watch::is_stale() const {
    const std::lock_guard lock(mutex_);
    return is_ending_ || is_reload_asked_;
}

void Watch::work() {
    const CancelScope scope([this] { return !is_stale(); });
    while (true) {
        std::optional<std::int64_t> frame;
        bool loads = false;
        bool draws = false;
        {
            std::unique_lock lock(mutex_);
            changed_.wait(lock, [&] {
                frame = next_frame();
                return is_ending_ || is_reload_asked_ || are_curves_wanted_ || frame;
            });
            if (is_ending_) break;
            loads = std::exchange(is_reload_asked_, false);
            draws = frame && (!are_curves_wanted_ || is_awaited(*frame));
        }
        try {
            if (loads)
                load();
            else if (draws)
                draw(*frame);
            else
                read_curves();
        } catch (const Error& error) {
            if (!is_interruption(error.code())) fail(error.problems());
        } catch (const std::bad_alloc&) {
            fail({{{}, "out of memory", "a smaller scene may help"}});
        } catch (const std::exception& error) {
            fail({{{}, error.what(), {}}});
        }
    }
    shown_.reset();
}

void Watch::forget_film() {
    const std::lock_guard lock(mutex_);
    film_ = nullptr;
    frames_ = 0;
    ++film_number_;
    pictures_.clear();
    picture_bytes_ = 0;
    curves_.reset();
}

OnProgress Watch::progress() {
    return [this, shown = Clock::now()](std::int64_t done, std::int64_t total) mutable {
        constexpr auto kSilent = std::chrono::milliseconds(300);
        if (const auto now = Clock::now(); now - shown > kSilent) {
            shown = now;
            update([&] {
                progress_ = total > 0 ? static_cast<double>(done) / static_cast<double>(total) : 0.0;
                ++version_;
            });
        }
        return true;
    };
}

void Watch::load() {
    int side_px = 0;
    NumberChanges changes;
    std::vector<Setting> settings;
    update([&] {
        is_busy_ = true;
        progress_ = 0.0;
        ++version_;
        side_px = def_.longest_side_px;
        changes = changes_;
        settings = def_.settings;
    });
    const std::string text = scene::read_file(def_.path);
    const std::vector<SceneNumber> numbers = numbers_of(text, def_.path, settings);
    {
        const std::lock_guard lock(mutex_);
        text_ = text;
        numbers_ = numbers;
        std::erase_if(changes_, [&](const auto& change) {  // of a number that the file has no more
            return std::ranges::none_of(
                numbers, [&](const SceneNumber& number) { return number.key == change.first; });
        });
    }
    Scene scene = parse_scene(text, def_.path, settings, {"slider", settings_of(changes, numbers)});
    const std::pair full_px(scene.video.width_px, scene.video.height_px);
    scene.video.scale_to(std::min(side_px, std::max(full_px.first, full_px.second)));
    FilmDef def = def_.film;
    def.readings.velocities = true;
    def.on_progress = progress();
    const Film shown(scene, def);
    static_cast<void>(shown.state(shown.frame_count() - 1));  // a motion that diverges is an error
    static_cast<void>(shown.gl());                            // so is a driver that cannot draw it
    forget_film();
    shown_ = shown;
    const VideoDef& video = shown.scene().video;
    const Rational fps = video.fps.rational();
    publish({{"name", shown.scene().name},
             {"frames", shown.frame_count()},
             {"fps", static_cast<double>(fps.num) / static_cast<double>(fps.den)},
             {"frame_s", shown.time_s(1)},
             {"width", video.width_px},
             {"height", video.height_px},
             {"full", {full_px.first, full_px.second}},
             {"plan", plan_lines(shown)}});
}

void Watch::publish(Json film) {
    std::int64_t playhead = 0;
    {
        const std::lock_guard lock(mutex_);
        frames_ = film["frames"].get<std::int64_t>();
        playhead = playhead_ = std::clamp<std::int64_t>(playhead_, 0, frames_ - 1);
        film["number"] = film_number_;
        film_ = std::move(film);
    }
    draw(playhead);  // before the page asks for it
    update([this] {
        problems_ = Json::array();
        is_busy_ = false;
        ++version_;
    });
}

void Watch::fail(const std::vector<Problem>& problems) {
    update([&] {
        problems_ = Json::array();
        for (const Problem& problem : problems) problems_.push_back(json_of(problem, def_.path));
        is_busy_ = false;
        are_curves_wanted_ = false;
        ++version_;
    });
}

void Watch::draw(std::int64_t k) {
    Picture picture;
    try {
        picture.png = media::png_bytes(shown_->frame(k), {});
    } catch (const Error& error) {
        if (is_interruption(error.code())) throw;
        picture.error = error.what();
    }
    update([&] { keep(k, std::move(picture)); });
}

void Watch::read_curves() {
    constexpr std::int64_t kMaxPoints = 1200;
    const Film& film = *shown_;
    const auto tracked = film::tracked_particles(film.system());
    const std::int64_t stride = 1 + (film.frame_count() - 1) / kMaxPoints;
    Json curves = {{"t", Json::array()},
                   {"angle_deg", Json::array()},
                   {"kinetic_j", Json::array()},
                   {"potential_j", Json::array()}};
    for (std::int64_t k = 0; k < film.frame_count(); k += stride) {
        check_cancelled();
        const State state = film.state(k);
        curves["t"].push_back(film.time_s(k));
        if (!tracked.empty() && tracked.front().pin)
            curves["angle_deg"].push_back(film::turning_of(tracked.front(), state, nullptr).x * 180.0 /
                                          std::numbers::pi);
        const Energy energy = film.energy_of(state);
        curves["kinetic_j"].push_back(energy.kinetic_j);
        curves["potential_j"].push_back(energy.potential_j());
    }
    update([&] {
        curves_ = curves.dump();
        are_curves_wanted_ = false;
    });
}

/// How many frames the film plays from the playhead to frame `k`.
std::int64_t Watch::distance(std::int64_t k) const {
    return k >= playhead_ ? k - playhead_ : k - playhead_ + frames_;
}

/// The frame to draw next: one that was asked for, or the next one after the playhead while there is room.
std::optional<std::int64_t> Watch::next_frame() const {
    if (film_.is_null() || is_busy_) return std::nullopt;
    if (is_awaited(playhead_) && !pictures_.contains(playhead_)) return playhead_;
    for (auto next = waiting_.lower_bound({film_number_, 0}); next != waiting_.end(); ++next)
        if (!pictures_.contains(next->second)) return next->second;
    if (std::ssize(pictures_) >= frames_) return std::nullopt;
    std::int64_t ahead = 0;
    while (pictures_.contains((playhead_ + ahead) % frames_)) ++ahead;
    const auto is_farther = [&](const auto& entry) { return distance(entry.first) > ahead; };
    // Half of the room, so that a frame that is drawn ahead is not itself the first one to go.
    const bool has_room =
        picture_bytes_ < def_.picture_bytes / 2 || std::ranges::any_of(pictures_, is_farther);
    return has_room ? std::optional((playhead_ + ahead) % frames_) : std::nullopt;
}

void Watch::keep(std::int64_t k, Picture picture) {
    picture_bytes_ += picture.png.size();
    pictures_.insert_or_assign(k, std::move(picture));
    // One that a request waits for stays until it is taken.
    const auto rank = [&](const auto& entry) { return is_awaited(entry.first) ? -1 : distance(entry.first); };
    while (picture_bytes_ > def_.picture_bytes && pictures_.size() > 1) {
        const auto last = std::ranges::max_element(pictures_, {}, rank);
        if (is_awaited(last->first)) break;
        picture_bytes_ -= last->second.png.size();
        pictures_.erase(last);
    }
}

Response Watch::answer(const Request& request) {
    if (!request.is_post) {
        if (request.path.empty()) return page_response("text/html", kWatchHtml);
        if (request.path == "style.css") return page_response("text/css", kStyleCss);
        if (request.path == "watch.js") return page_response("text/javascript", kWatchJs);
        if (request.path == "state") return state_after(number_in(request, "after"));
        if (request.path == "curves") return curves(number_in(request, "film"));
        const std::string_view path = request.path;
        constexpr std::string_view kFrame = "frame/";
        constexpr std::string_view kPng = ".png";
        if (path.starts_with(kFrame) && path.ends_with(kPng))
            return frame(number_of(path.substr(kFrame.size(), path.size() - kFrame.size() - kPng.size())),
                         number_in(request, "film"));
        return text_response(404, "there is no such page\n");
    }
    const Json body = Json::parse(request.body, nullptr, false);
    if (request.path == "number" && body.is_object()) return change_number(body);
    if (request.path == "write") return write_file();
    if (request.path == "side" && body.is_object() && body.contains("px") && body["px"].is_number_integer()) {
        {
            const std::lock_guard lock(mutex_);
            def_.longest_side_px = std::clamp(body["px"].get<int>(), kMinSidePx, kMaxSidePx);
        }
        reload();
        return {};
    }
    return text_response(400, "no such request\n");
}

Response Watch::state_after(std::int64_t version) {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, kLongestWait, [&] { return is_ending_ || version_ != version; });
    Json numbers = Json::array();
    for (const SceneNumber& number : numbers_) numbers.push_back(json_of(number, changes_));
    return {200, "application/json",
            Json{{"version", version_},
                 {"busy", is_busy_},
                 {"progress", progress_},
                 {"ended", is_ending_},
                 {"file", def_.path},
                 {"film", film_},
                 {"problems", problems_},
                 {"numbers", numbers},
                 {"changes", changes_.size()}}
                .dump(-1, ' ', false, Json::error_handler_t::replace)};
}

Response Watch::frame(std::int64_t k, std::int64_t film) {
    std::unique_lock lock(mutex_);
    if (film != film_number_ || k < 0 || k >= frames_)
        return text_response(410, "this frame is not in the present film\n");
    playhead_ = k;
    const auto waiting = waiting_.insert({film, k});
    changed_.notify_all();
    const auto is_over = [&] { return is_ending_ || film != film_number_ || pictures_.contains(k); };
    changed_.wait_for(lock, kLongestWait, is_over);
    waiting_.erase(waiting);
    if (film != film_number_) return text_response(410, "this frame is not in the present film\n");
    const auto found = pictures_.find(k);
    if (found == pictures_.end()) return text_response(503, "this frame is not drawn yet; ask again\n");
    if (!found->second.error.empty()) return text_response(422, found->second.error);
    return {200, "image/png", found->second.png};
}

Response Watch::curves(std::int64_t film) {
    std::unique_lock lock(mutex_);
    if (film != film_number_ || film_.is_null())
        return text_response(410, "these curves are not of the present film\n");
    if (!curves_) are_curves_wanted_ = true;
    changed_.notify_all();
    changed_.wait_for(lock, kLongestWait,
                      [&] { return is_ending_ || film != film_number_ || curves_ || !are_curves_wanted_; });
    if (film != film_number_ || !(curves_ || are_curves_wanted_))
        return text_response(410, "there are no curves\n");
    if (!curves_) return text_response(503, "the curves are not read yet; ask again\n");
    return {200, "application/json", *curves_};
}

Response Watch::change_number(const Json& body) {
    {
        const std::lock_guard lock(mutex_);
        const auto number = std::ranges::find_if(numbers_, [&](const SceneNumber& candidate) {
            return body.contains("key") && body["key"] == candidate.key;
        });
        const Json value = body.value("value", Json());
        if (number == numbers_.end()) return text_response(400, "the scene has no such number\n");
        if (value.is_number() && value.get<double>() != number->value)
            changes_[number->key] = value.get<double>();
        else
            changes_.erase(number->key);
    }
    reload();
    return {};
}

Response Watch::write_file() {
    std::string text;
    NumberChanges changes;
    {
        const std::lock_guard lock(mutex_);
        if (is_busy_ || is_reload_asked_ || !problems_.empty())
            return text_response(409,
                                 "numbers are written once the scene with them is shown without errors\n");
        text = text_;
        changes = changes_;
    }
    if (scene::read_file(def_.path) != text)
        return text_response(409, "the file has changed; look at its new state, and write again\n");
    save_file(def_.path, with_changes(text, def_.path, changes));
    {
        const std::lock_guard lock(mutex_);
        // What has changed since stays a change, and a number in the file counts again in place of --set.
        for (const auto& [key, value] : changes) {
            if (const auto now = changes_.find(key); now != changes_.end() && now->second == value)
                changes_.erase(now);
            for (SceneNumber& number : numbers_)
                if (number.key == key) number.value = value;
            std::erase_if(def_.settings,
                          [&changed = key](const Setting& setting) { return sets(setting, changed); });
        }
    }
    reload();
    return {};
}

}  // namespace corda::serve
