#include "corda/serve/film_render.hpp"

#include <exception>
#include <utility>

#include <fmt/format.h>

#include "corda/core/text.hpp"

namespace corda::serve {

using Json = nlohmann::json;

template <class Change>
void FilmRender::update(const Change& change) {
    {
        const std::lock_guard lock(mutex_);
        change(json_);
    }
    on_change_();
}

void FilmRender::start(const Film& film, const std::string& path, bool force) {
    if (const Json last = json(); last.is_object() && last["is_running"] == true)
        throw Error(ExitCode::kUsage, "a render is running already");
    RenderDef def;
    def.force = force;
    const CheckedOutput output = check_render(film.scene(), path, def, film.scene().source);
    stop();  // its thread has ended
    is_stopping_ = false;
    update([&](Json& json) {
        json = {{"path", path}, {"is_running", true}, {"progress", 0.0}, {"text", ""}};
    });
    thread_ = std::jthread([this, film, output] { render(film, output); });
}

void FilmRender::stop() {
    is_stopping_ = true;
    if (thread_.joinable()) thread_.join();
}

Json FilmRender::json() const {
    const std::lock_guard lock(mutex_);
    return json_;
}

void FilmRender::render(const Film& film, const CheckedOutput& output) {
    std::string text;
    try {
        const Rendered rendered = render_video(film, output, [&](std::int64_t done, std::int64_t total) {
            const double progress = static_cast<double>(done) / static_cast<double>(total);
            constexpr double kStep = 0.01;  // the page shows per cents
            if (progress >= json()["progress"].get<double>() + kStep)
                update([&](Json& json) { json["progress"] = progress; });
            return !is_stopping_;
        });
        text = rendered.complete ? fmt::format("{} written", counted(rendered.frames, "frame"))
                                 : "stopped; nothing was written";
    } catch (const std::exception& error) {
        text = error.what();
    }
    update([&](Json& json) {
        json["is_running"] = false;
        json["text"] = printable_lines(text);
    });
}

}  // namespace corda::serve
