#include "corda/serve/review.hpp"

#include <algorithm>
#include <charconv>
#include <chrono>
#include <utility>

#include <nlohmann/json.hpp>

#include "corda/core/file.hpp"
#include "corda/golden/cases.hpp"
#include "corda/media/bytes.hpp"
#include "embedded_page.hpp"

namespace corda::serve {

using golden::Checked;
using Json = nlohmann::json;

Review::Review(golden::SuiteDef def, const golden::SuiteResult& result) : def_(std::move(def)) {
    for (const Checked& picture : result.pictures)
        if (picture.failed()) pictures_.push_back(picture);
}

Response Review::answer(const Request& request) {
    if (request.is_post) {
        const Json body = Json::parse(request.body, nullptr, false);
        if (request.path == "apply" && body.is_object() && body.value("accept", Json()).is_array()) {
            std::vector<std::string> names;
            for (const Json& name : body["accept"])
                if (name.is_string()) names.push_back(name);
            return apply(names);
        }
        if (request.path == "mark" && body.is_object() && body.value("marks", Json()).is_object())
            return mark(body["marks"]);
        if (request.path != "end") return text_response(400, "no such request\n");
        {
            const std::lock_guard lock(mutex_);
            has_ended_ = true;
        }
        ended_.notify_all();
        return {};
    }
    if (request.path.empty()) return page_response("text/html", kReviewHtml);
    if (request.path == "style.css") return page_response("text/css", kStyleCss);
    if (request.path == "review.js") return page_response("text/javascript", kReviewJs);
    if (request.path == "pictures") {
        const std::lock_guard lock(mutex_);
        Json all = Json::array();
        for (const Checked& picture : pictures_) {
            Json json = golden::picture_json(picture);
            json["figures"] = figures_text(picture);
            json["has_reference"] = !picture.reference.empty();
            json["has_new"] = !picture.drawn_path.empty();
            json["accepted"] = accepted_.contains(picture.name);
            const auto mark = marks_.find(picture.name);
            json["mark"] = mark == marks_.end() ? "" : mark->second;
            all.push_back(std::move(json));
        }
        return {200, "application/json", all.dump(-1, ' ', false, Json::error_handler_t::replace)};
    }
    return picture(request.path);
}

Response Review::picture(std::string_view path) const {
    constexpr std::string_view kPicture = "picture/";
    const auto none = [] { return text_response(404, "there is no such picture\n"); };
    if (!path.starts_with(kPicture)) return none();
    path.remove_prefix(kPicture.size());
    std::size_t index = 0;
    const auto [end, status] = std::from_chars(path.data(), path.data() + path.size(), index);
    if (status != std::errc{} || index >= pictures_.size()) return none();
    const Checked& shown = pictures_[index];
    const std::string_view kind(end, path.data() + path.size());
    if (kind == "/reference.png" && !shown.reference.empty())
        return {200, "image/png", file_bytes(shown.reference)};
    if (kind == "/new.png" && !shown.drawn_path.empty())
        return {200, "image/png", file_bytes(shown.drawn_path)};
    if (kind == "/difference.png" && !shown.reference.empty() && !shown.drawn_path.empty())
        return {
            200, "image/png",
            media::png_bytes(golden::amplified(read_png(shown.reference), read_png(shown.drawn_path)), {})};
    return none();
}

Response Review::mark(const Json& marks) {
    const std::lock_guard lock(mutex_);
    for (const Checked& picture : pictures_) {
        const auto mark = marks.find(picture.name);
        if (mark == marks.end() || !mark->is_string()) continue;
        const auto& word = mark->get_ref<const std::string&>();
        if (word.empty() || word == "accept" || word == "reject") marks_[picture.name] = word;
    }
    return {};
}

Response Review::apply(const std::vector<std::string>& names) {
    const std::lock_guard lock(mutex_);
    golden::SuiteDef def = def_;
    def.accepted = {def_.new_folder};
    def.new_folder.clear();
    def.only.clear();
    for (const Checked& picture : pictures_)
        if (!picture.drawn_path.empty() && std::ranges::find(names, picture.name) != names.end() &&
            !accepted_.contains(picture.name))
            def.only.push_back(picture.name);
    if (def.only.empty())
        return text_response(400, "none of these can be accepted; golden --update removes stale pictures\n");
    const golden::SuiteResult result = golden::accept(def);
    for (const Checked& picture : result.pictures) accepted_.insert(picture.name);
    return {200, "application/json", Json{{"changed", result.changed()}}.dump()};
}

bool Review::wait(int timeout_ms) {
    std::unique_lock lock(mutex_);
    return ended_.wait_for(lock, std::chrono::milliseconds(timeout_ms), [this] { return has_ended_; });
}

std::size_t Review::open_count() const {
    const std::lock_guard lock(mutex_);
    return pictures_.size() - accepted_.size();
}

std::size_t Review::accepted_count() const {
    const std::lock_guard lock(mutex_);
    return accepted_.size();
}

}  // namespace corda::serve
