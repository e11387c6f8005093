#include <algorithm>
#include <typeindex>
#include <variant>
#include <vector>

#include "corda/scene/document.hpp"
#include "corda/scene/field.hpp"
#include "corda/scene/scene.hpp"

namespace corda {
namespace {

using namespace scene;  // the schema

/// The definitions of a scene that keys in pixels are bound to.
std::vector<void*> defs_of(Scene& scene, const Key& key, std::type_index type) {
    if (type == typeid(StyleDef)) return {&scene.style};
    if (type == typeid(OverlayDef)) return {&scene.overlay};
    if (type == typeid(OverlayTextDef)) {
        std::vector<void*> defs;
        for (OverlayTextDef& text : scene.overlay.texts) defs.push_back(&text);
        return defs;
    }
    if (type == typeid(BodyStyleDef)) {
        const std::size_t ropes = std::min(scene.ropes.size(), scene.body_styles.size());
        const bool are_ropes = key.section == "rope";
        std::vector<void*> defs;
        for (std::size_t i = are_ropes ? 0 : ropes; i < (are_ropes ? ropes : scene.body_styles.size()); ++i)
            defs.push_back(&scene.body_styles[i]);
        return defs;
    }
    if (AutoDef* const solver = std::get_if<AutoDef>(&scene.solver); type == typeid(AutoDef) && solver)
        return {solver};
    return {};
}

/// A key that has its default stays: defaults follow the size.
void scale_field(const Key& key, const Field& field, void* def, double factor) {
    const std::string text = field.toml(key, def);
    if (text.empty() || text == field.initial(key)) return;
    Problems problems("");
    toml::table scaled = toml::parse("px = " + text);
    const auto scale = [&](toml::node& node) {
        return toml::value<double>(
            std::clamp(factor * number_of(node), key.type.range.low, key.type.range.high));
    };
    if (toml::array* const list = scaled.get("px")->as_array())
        for (std::size_t i = 0; i < list->size(); ++i)
            list->replace(list->cbegin() + static_cast<std::ptrdiff_t>(i), scale(*list->get(i)));
    else
        scaled.insert_or_assign("px", scale(*scaled.get("px")));
    field.read(key, Value(problems, *scaled.get("px"), "px"), def);
}

}  // namespace

void scale_px(Scene& scene, double factor) {
    for (const Key& key : all_keys()) {
        if (key.unit != "px") continue;
        for (const Field& field : key.binding.fields)
            for (void* const def : defs_of(scene, key, field.def)) scale_field(key, field, def, factor);
    }
}

Scene scaled_to(Scene scene, int width_px, int height_px) {
    VideoDef& video = scene.video;
    scale_px(scene, 1.0 * std::min(width_px, height_px) / std::min(video.width_px, video.height_px));
    video.width_px = width_px;
    video.height_px = height_px;
    return scene;
}

}  // namespace corda
