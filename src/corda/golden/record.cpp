#include "corda/golden/record.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "corda/core/text.hpp"
#include "corda/pipeline/plan_text.hpp"
#include "corda/scene/write_scene.hpp"

namespace corda::golden {

GoldenRecord record_of(Film& film, double time_s) {
    const CameraDef& camera = film.camera();
    GoldenRecord record{.renderer = film.gl().renderer,
                        .solver = solver_setting(frozen_scene(film)),
                        .center_m = *camera.center_m,
                        .height_m = *camera.height_m,
                        .margin = camera.margin,
                        .color_scale = film.color_scale()};
    const State& state = film.state_at(time_s);
    std::vector<double> positions_m;
    for (std::size_t i = 0; i < state.x_m.size(); ++i)
        positions_m.insert(positions_m.end(), {state.x_m[i], state.y_m[i]});
    record.state =
        hash_text({reinterpret_cast<const char*>(positions_m.data()), positions_m.size() * sizeof(double)});
    constexpr std::size_t kMax = GoldenRecord::kMaxParticles;
    const std::size_t stride = std::max<std::size_t>(1, (state.x_m.size() + kMax - 1) / kMax);
    for (std::size_t i = 0; i < state.x_m.size(); i += stride)
        record.positions_m.insert(record.positions_m.end(), {state.x_m[i], state.y_m[i]});
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

std::vector<Setting> freezing(const Scene& scene, const std::optional<GoldenRecord>& made) {
    std::vector<Setting> settings;
    if (!made) return settings;
    const bool is_open = std::holds_alternative<AutoDef>(scene.solver) && scene.body_solvers.empty();
    if (is_open) settings.push_back(made->solver);
    // A picture with another margin has a camera of another scene.
    if (made->margin != scene.camera.margin) return settings;
    if (!scene.camera.center_m)
        settings.push_back(fmt::format("camera.center=[{}, {}]", made->center_m.x, made->center_m.y));
    if (!scene.camera.height_m) settings.push_back(fmt::format("camera.height={}", made->height_m));
    return settings;
}

std::optional<double> largest_distance_m(const GoldenRecord& a, const GoldenRecord& b) {
    if (a.positions_m.empty() || a.positions_m.size() != b.positions_m.size()) return std::nullopt;
    double largest = 0.0;
    for (std::size_t i = 0; i + 1 < a.positions_m.size(); i += 2)
        largest = std::max(largest, std::hypot(a.positions_m[i] - b.positions_m[i],
                                               a.positions_m[i + 1] - b.positions_m[i + 1]));
    return largest;
}

std::map<std::string, std::string> pixel_digest(const Scene& scene) {
    auto all = digest(scene);
    std::erase_if(all, [](const auto& entry) {
        constexpr std::array kOfPixels{"video.size", "video.fps", "video.shutter", "video.subframes"};
        return entry.first.starts_with("video.") &&
               std::ranges::find(kOfPixels, entry.first) == kOfPixels.end();
    });
    return all;
}

std::string scene_change(const std::string& reference, const Scene& now,
                         const std::vector<Setting>& settings) {
    std::vector<std::string> changes;
    try {
        changes =
            differences(pixel_digest(now), pixel_digest(scene_of(read_provenance(reference), reference)));
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

Cause cause_of(const Provenance& kept, const GoldenRecord& now, const std::vector<std::string>& fonts) {
    if (!kept.golden) {
        constexpr const char* kUnknown = "pixels differ; the reference does not say how it was made";
        return {kUnknown, kUnknown};
    }
    const GoldenRecord& reference = *kept.golden;
    if (reference.state != now.state) {
        const auto distance_m = largest_distance_m(reference, now);
        const std::string why = reference.solver == now.solver ? "" : ", by another solver";
        if (!distance_m) return {"another number of particles" + why, "another number of particles"};
        const std::string group = "positions differ" + why;
        if (*distance_m > 0.0)
            return {fmt::format("positions differ by {:.2g} m{}", *distance_m, why), group};
        return {fmt::format("positions differ, if not those of the particles that are kept{}", why), group};
    }
    if (reference.center_m != now.center_m || reference.height_m != now.height_m)
        return {"same positions, other camera", "other camera"};
    const auto drawn = [](const std::string& how) { return Cause{"same positions and camera, " + how, how}; };
    if (!reference.color_scale.empty() && reference.color_scale != now.color_scale)
        return drawn(fmt::format("another scale of colours: {}, now {}", reference.color_scale,
                                 now.color_scale.empty() ? "none" : now.color_scale));
    if (const std::string change = font_change(kept, fonts); !change.empty()) return drawn(change);
    if (kept.corda != version())
        return drawn(fmt::format("drawn by another version of Corda: {}, now {}", kept.corda, version()));
    if (reference.renderer != now.renderer)
        return drawn(fmt::format("drawn by another OpenGL: {}, now {}", reference.renderer, now.renderer));
    return {"same positions, camera and version, but pixels differ", kPixelsDiffer};
}

}  // namespace corda::golden
