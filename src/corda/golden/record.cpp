#include "corda/golden/record.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "corda/core/text.hpp"
#include "corda/film/plan_text.hpp"

namespace corda::golden {

GoldenRecord record_of(const Film& film) {
    GoldenRecord record{.renderer = film.gl().renderer};
    for (const KeyChange& choice : differences(values_of(frozen_scene(film)), values_of(film.scene())))
        if (choice.now) record.chosen.emplace(choice.key, *choice.now);
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
        constexpr std::array kOfPixels{"video.size", "video.fps", "video.speed", "video.shutter",
                                       "video.subframes"};
        return entry.first.starts_with("video.") &&
               std::ranges::find(kOfPixels, entry.first) == kOfPixels.end();
    });
    return all;
}

std::vector<KeyChange> scene_changes(const Provenance& kept, const Scene& now,
                                     const std::vector<Setting>& settings) {
    std::vector<KeyChange> changes;
    try {
        changes = differences(pixel_values(now), pixel_values(scene_of(kept, now.source)));
    } catch (const Error&) {  // of another Corda, whose scenes this one does not read
        return {};
    }
    for (KeyChange& change : changes)
        change.is_set = std::ranges::any_of(settings, [&](const Setting& setting) {
            const std::string key = setting.substr(0, setting.find_first_of("= "));
            return change.key == key || change.key.starts_with(key + '.') ||
                   change.key.starts_with(key + '[');
        });
    return changes;
}

Cause cause_of(const Provenance& kept, const GoldenRecord& made, const Scene& now,
               const std::vector<Setting>& settings) {
    using Kind = Cause::Kind;
    if (!kept.golden) return {.kind = Kind::kUnrecorded};
    Cause cause{.kind = Kind::kScene, .changed = scene_changes(kept, now, settings)};
    // Pictures of earlier versions do not tell what was chosen.
    if (!kept.golden->chosen.empty()) cause.chosen = differences(made.chosen, kept.golden->chosen);
    // A key that the scene now gives, or gave before, is no consequence.
    std::erase_if(cause.chosen, [&](const KeyChange& choice) {
        return std::ranges::find(cause.changed, choice.key, &KeyChange::key) != cause.changed.end();
    });
    if (!cause.changed.empty()) return cause;
    if (!cause.chosen.empty()) return {.kind = Kind::kChoice, .chosen = cause.chosen};
    if (kept.corda != version())
        return {.kind = Kind::kVersion, .stored = kept.corda, .now = std::string(version())};
    if (kept.golden->renderer != made.renderer)
        return {.kind = Kind::kRenderer, .stored = kept.golden->renderer, .now = made.renderer};
    return {.kind = Kind::kPixels};
}

}  // namespace corda::golden
