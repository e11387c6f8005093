#include "corda/serve/watch.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <iterator>
#include <string_view>
#include <utility>

#include "corda/core/file.hpp"
#include "corda/core/output_file.hpp"
#include "corda/core/text.hpp"
#include "corda/film/plan_text.hpp"
#include "corda/film/provenance.hpp"
#include "corda/media/bytes.hpp"
#include "corda/scene/scene.hpp"
#include "corda/serve/watch_state.hpp"
#include "embedded_page.hpp"

namespace corda::serve {

using Json = nlohmann::json;

namespace {

/// The connections that a browser opens to a program are few, and all its pages share them.
constexpr auto kLongestWait = std::chrono::seconds(2);
constexpr auto kStateWait = std::chrono::milliseconds(200);  // visible pages ask all the time
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
    return {{"key", number.key},           {"value", change == changes.end() ? number.value : change->second},
            {"unchanged", number.value},   {"is_integer", number.is_integer},
            {"low", number.low},           {"high", number.high},
            {"low_open", number.low_open}, {"unit", number.unit},
            {"meaning", number.meaning},   {"line", number.line}};
}

/// -1 for a text that is no number.
std::int64_t number_of(std::string_view text) {
    return whole_number<std::int64_t>(text).value_or(-1);
}

std::int64_t number_in(const Request& request, std::string_view name) {
    const auto found = request.query.find(name);
    return found == request.query.end() ? 0 : number_of(found->second);
}

void ask_for_reload(WatchState& state) {
    update(state, [&] { state.is_reload_asked = true; });
}

Response state_after(WatchState& state, std::int64_t version) {
    std::unique_lock lock(state.mutex);
    if (!state.changed.wait_for(lock, kStateWait,
                                [&] { return state.is_ending || state.version != version; }))
        return {204, "", ""};
    Json problems = Json::array();
    for (const Problem& problem : state.problems) problems.push_back(json_of(problem, state.def.path));
    Json numbers = Json::array();
    for (const SceneNumber& number : state.numbers) numbers.push_back(json_of(number, state.changes));
    return {200, "application/json",
            Json{{"version", state.version},
                 {"busy", state.is_busy},
                 {"progress", state.progress},
                 {"side", {{"px", state.side_px}, {"fits", state.fits}}},
                 {"render", state.render.json()},
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

/// The film in pictures of another size.
Response set_side(WatchState& state, int side_px, bool fits) {
    update(state, [&] {
        ++state.version;
        state.fits = fits;
        if (std::exchange(state.side_px, std::clamp(side_px, kMinSidePx, kMaxSidePx)) == state.side_px)
            return;
        if (!state.film) return;
        const std::shared_ptr<ShownFilm> last = state.film;
        state.film = next_film(state, last->film, last->words);
        state.film->curves = last->curves;
    });
    return {};
}

/// The film that a page shows; null if it shows another one.
std::shared_ptr<const ShownFilm> film_of(WatchState& state, std::int64_t number) {
    const std::lock_guard lock(state.mutex);
    return state.film && state.film->number == number ? state.film : nullptr;
}

Response still(WatchState& state, std::int64_t k, std::int64_t number) {
    const std::shared_ptr<const ShownFilm> shown = film_of(state, number);
    if (!shown || k < 0 || k >= shown->film.frame_count())
        return text_response(410, "this frame is not in the present film\n");
    const Film& film = shown->film;
    const PngInfo info = picture_info(film.scene().name, fmt::format("{}", film.time_s(k)), std::to_string(k),
                                      provenance_text(provenance_of(film.scene())));
    return {200, "image/png", media::png_bytes(film.frame(k), info)};
}

Response start_render(WatchState& state, const Json& body) {
    std::shared_ptr<const ShownFilm> shown;
    {
        const std::lock_guard lock(state.mutex);
        if (state.is_busy || state.is_reload_asked || !state.problems.empty() || !state.film)
            return text_response(409, "a film is rendered once it is shown without errors\n");
        shown = state.film;
    }
    const std::string ending = body.value("ending", "");
    constexpr std::string_view kEndings[] = {"mp4", "webm", "mov", "gif"};
    if (std::ranges::find(kEndings, ending) == std::end(kEndings))
        return text_response(400, "no such ending\n");
    const std::string path = std::filesystem::path(state.def.path).replace_extension(ending).string();
    const bool force = body.value("force", false);
    if (!force && is_there(path)) return {409, "application/json", Json{{"exists", printable(path)}}.dump()};
    state.render.start(shown->film, path, force);
    return {};
}

Response answer_post(WatchState& state, const Request& request) {
    const Json body = Json::parse(request.body, nullptr, false);
    if (!body.is_object()) return text_response(400, "no such request\n");
    if (request.path == "number") return change_number(state, body);
    if (request.path == "write") return write_file(state);
    if (request.path == "render") return start_render(state, body);
    if (request.path == "stop") {
        state.render.stop();
        return {};
    }
    if (request.path != "side" || !body.value("px", Json()).is_number_integer())
        return text_response(400, "no such request\n");
    return set_side(state, body["px"].get<int>(), body.value("fits", Json()) == true);
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
    state_->render.stop();
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
    const std::int64_t film = number_in(request, "film");
    if (request.path == "curves") return curves(*state_, film);
    const std::string_view path = request.path;
    constexpr std::string_view kPng = ".png";
    const std::size_t slash = path.find('/');
    if (slash == std::string_view::npos || !path.ends_with(kPng))
        return text_response(404, "there is no such page\n");
    const std::int64_t k = number_of(path.substr(slash + 1, path.size() - slash - 1 - kPng.size()));
    if (path.starts_with("frame/")) return frame(*state_, k, film);
    if (path.starts_with("still/")) return still(*state_, k, film);
    return text_response(404, "there is no such page\n");
}

}  // namespace corda::serve
