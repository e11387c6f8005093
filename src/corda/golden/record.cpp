#include "corda/golden/record.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "corda/core/text.hpp"
#include "corda/film/plan_text.hpp"
#include "corda/scene/write_scene.hpp"

namespace corda::golden {

GoldenRecord record_of(Film& film) {
    GoldenRecord record{.renderer = film.gl().renderer, .chosen = values_of(frozen_scene(film))};
    for (const auto& [key, value] : values_of(film.scene())) {
        const auto same = record.chosen.find(key);
        if (same != record.chosen.end() && same->second == value) record.chosen.erase(same);
    }
    return record;
}

PngInfo to_png_info(GoldenRecord record, const Film& film, double time_s) {
    const Scene& scene = film.scene();
    Provenance origin = provenance_of(scene);
    origin.picture = PictureOrigin{
        .command = "still", .times = {{.frame = {}, .time_s = time_s}}, .shutter = scene.video.shutter};
    if (scene.golden) origin.picture->film_times_s = scene.golden->at_s;
    origin.golden = std::move(record);
    return picture_info(scene.name, fmt::format("{}", time_s), "", provenance_text(std::move(origin)));
}

std::map<std::string, std::string> pixel_values(const Scene& scene) {
    auto all = values_of(scene);
    std::erase_if(all, [](const auto& entry) {
        constexpr std::array kOfPixels{"video.size", "video.fps", "video.shutter", "video.subframes"};
        return entry.first.starts_with("video.") &&
               std::ranges::find(kOfPixels, entry.first) == kOfPixels.end();
    });
    return all;
}

std::string scene_change(const Provenance& kept, const Scene& now, const std::vector<Setting>& settings) {
    std::vector<std::string> changes;
    try {
        changes = differences(pixel_values(now), pixel_values(scene_of(kept, now.source)));
    } catch (const Error&) {  // of another Corda, whose scenes this one does not read
        return "";
    }
    for (std::string& change : changes) {
        const bool is_set = std::ranges::any_of(settings, [&](const Setting& setting) {
            const std::string key = setting.substr(0, std::min(setting.find('='), setting.find(' ')));
            return change.starts_with(key) &&
                   std::string_view(" .[").find(change[key.size()]) != std::string_view::npos;
        });
        if (is_set) change += " (by --set)";
    }
    return differences_text(changes);
}

Cause cause_of(const Provenance& kept, const GoldenRecord& made, const Scene& now,
               const std::vector<Setting>& settings) {
    const auto alone = [](const std::string& text) { return Cause{text, text}; };
    if (!kept.golden) return alone("pixels differ; the reference does not say how it was made");
    const std::string change = scene_change(kept, now, settings);
    // Pictures of earlier versions do not tell what was chosen.
    const std::string chosen =
        kept.golden->chosen.empty() ? "" : differences_text(differences(made.chosen, kept.golden->chosen));
    if (!change.empty()) return {(chosen.empty() ? "" : "another choice: " + chosen + "; ") + change, change};
    if (!chosen.empty())
        return {"same scene, another choice: " + chosen, "another solver or camera is chosen"};
    if (kept.corda != version())
        return alone(
            fmt::format("same scene, drawn by another version of Corda: {}, now {}", kept.corda, version()));
    if (kept.golden->renderer != made.renderer)
        return alone(fmt::format("same scene, drawn by another OpenGL: {}, now {}", kept.golden->renderer,
                                 made.renderer));
    return alone("same scene, version and OpenGL, but pixels differ");
}

}  // namespace corda::golden
