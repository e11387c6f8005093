#include "corda/golden/provenance.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>

#include "corda/core/text.hpp"
#include "corda/pipeline/provenance.hpp"
#include "corda/scene/write_scene.hpp"

namespace corda::golden {
namespace {

constexpr std::size_t kDigits = 16;  // of a double's bits

std::string hex_of(const std::vector<double>& values) {
    std::string text;
    text.reserve(values.size() * kDigits);
    for (const double value : values)
        fmt::format_to(std::back_inserter(text), "{:016x}", std::bit_cast<std::uint64_t>(value));
    return text;
}

std::vector<double> from_hex(std::string_view text) {
    std::vector<double> values;
    for (; text.size() >= kDigits; text.remove_prefix(kDigits)) {
        std::uint64_t bits = 0;
        const auto [end, failure] = std::from_chars(text.data(), text.data() + kDigits, bits, 16);
        const auto value = std::bit_cast<double>(bits);
        if (failure != std::errc() || end != text.data() + kDigits || !std::isfinite(value)) return {};
        values.push_back(value);
    }
    return values;
}

}  // namespace

Provenance provenance_of(Film& film, double time_s) {
    const CameraDef& camera = film.camera();
    Provenance made{.version = std::string(version()),
                    .scene = printable(film.scene().name),
                    .renderer = film.gl().renderer,
                    .solver = solver_setting(frozen_scene(film)),
                    .center = fmt::format("camera.center=[{}, {}]", camera.center_m->x, camera.center_m->y),
                    .height = fmt::format("camera.height={}", *camera.height_m),
                    .margin = fmt::format("{}", camera.margin),
                    .state = {},
                    .positions_m = {}};
    const State& state = film.state_at(time_s);
    for (std::size_t i = 0; i < state.x_m.size(); ++i) {
        made.positions_m.push_back(state.x_m[i]);
        made.positions_m.push_back(state.y_m[i]);
    }
    made.state = hash_text(
        {reinterpret_cast<const char*>(made.positions_m.data()), made.positions_m.size() * sizeof(double)});
    const std::size_t count = state.x_m.size();
    const std::size_t stride = (count + Provenance::kMaxKept - 1) / Provenance::kMaxKept;
    if (stride < 2) return made;
    std::vector<double> some;
    for (std::size_t i = 0; i < count; i += stride)
        some.insert(some.end(), {made.positions_m[2 * i], made.positions_m[2 * i + 1]});
    made.positions_m = std::move(some);
    return made;
}

PngInfo to_png_info(const Provenance& made, Film& film, double time_s) {
    corda::Provenance origin = corda::provenance_of(film.scene());
    origin.picture = PictureOrigin{.command = "still",
                                   .times = {{.frame = {}, .time_s = time_s}},
                                   .shutter = film.scene().video.shutter};
    if (film.scene().golden) origin.picture->film_times_s = film.scene().golden->at_s;
    PngInfo info;
    info.text = {{"Software", "corda " + made.version},
                 {"Title", made.scene},
                 {"Time", fmt::format("{} s", time_s)},
                 {"Renderer", made.renderer},
                 {"Corda-Solver", made.solver},
                 {"Corda-Center", made.center},
                 {"Corda-Height", made.height},
                 {"Corda-Margin", made.margin},
                 {"Corda-State", made.state}};
    info.text.emplace_back("Corda-Positions", hex_of(made.positions_m));
    info.text.emplace_back(kProvenanceKeyword, provenance_text(std::move(origin)));
    return info;
}

Provenance from_png_info(const PngInfo& info) {
    Provenance made;
    for (const auto& [key, text] : info.text) {
        if (key == "Software" && text.starts_with("corda ")) made.version = text.substr(6);
        if (key == "Title") made.scene = text;
        if (key == "Renderer") made.renderer = text;
        if (key == "Corda-Solver" && text.starts_with("solver=")) made.solver = text;
        if (key == "Corda-Center" && text.starts_with("camera.center=")) made.center = text;
        if (key == "Corda-Height" && text.starts_with("camera.height=")) made.height = text;
        if (key == "Corda-Margin") made.margin = text;
        if (key == "Corda-State") made.state = text;
        if (key == "Corda-Positions") made.positions_m = from_hex(text);
    }
    return made;
}

std::vector<Setting> freezing(const Scene& scene, const Provenance& made) {
    std::vector<Setting> settings;
    const bool is_open = std::holds_alternative<AutoDef>(scene.solver) && scene.body_solvers.empty();
    if (is_open && !made.solver.empty()) settings.push_back(made.solver);
    // A picture with another margin has a camera of another scene.
    if (!made.margin.empty() && made.margin != fmt::format("{}", scene.camera.margin)) return settings;
    if (!scene.camera.center_m && !made.center.empty()) settings.push_back(made.center);
    if (!scene.camera.height_m && !made.height.empty()) settings.push_back(made.height);
    return settings;
}

std::optional<double> largest_distance_m(const Provenance& a, const Provenance& b) {
    if (a.positions_m.empty() || a.positions_m.size() != b.positions_m.size()) return std::nullopt;
    double largest = 0.0;
    for (std::size_t i = 0; i + 1 < a.positions_m.size(); i += 2)
        largest = std::max(largest, std::hypot(a.positions_m[i] - b.positions_m[i],
                                               a.positions_m[i + 1] - b.positions_m[i + 1]));
    return largest;
}

std::string scene_change(const std::string& reference, const Scene& now) {
    const auto of_pixels = [](const Scene& scene) {
        auto all = digest(scene);
        std::erase_if(all, [](const auto& entry) {
            constexpr std::array kOfPixels{"video.size", "video.shutter", "video.subframes"};
            const std::string& key = entry.first;
            return key.starts_with("video.") &&
                   std::find(kOfPixels.begin(), kOfPixels.end(), key) == kOfPixels.end();
        });
        return all;
    };
    try {
        return differences_text(
            differences(of_pixels(now), of_pixels(scene_of(read_provenance(reference), reference))));
    } catch (const Error&) {  // of another Corda, whose scenes this one does not read
        return "";
    }
}

std::string cause_of(const Provenance& reference, const Provenance& now) {
    if (!reference.is_golden()) return "pixels differ; the reference does not say how it was made";
    if (reference.state != now.state) {
        const auto distance_m = largest_distance_m(reference, now);
        const std::string why = reference.solver == now.solver ? "" : ", by another solver";
        if (!distance_m) return fmt::format("another number of particles{}", why);
        if (*distance_m > 0.0) return fmt::format("positions differ by {:.2g} m{}", *distance_m, why);
        return fmt::format("positions differ, if not those of the particles that are kept{}", why);
    }
    if (reference.center != now.center || reference.height != now.height)
        return "same positions, other camera";
    if (reference.version != now.version)
        return fmt::format("same positions and camera, drawn by another version of Corda: {}, now {}",
                           reference.version, now.version);
    if (reference.renderer != now.renderer)
        return fmt::format("same positions and camera, drawn by another OpenGL: {}, now {}",
                           reference.renderer, now.renderer);
    return "same positions, camera and version, but pixels differ";
}

}  // namespace corda::golden
