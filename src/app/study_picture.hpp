#pragma once

#include <optional>

#include "corda/scene/scene.hpp"
#include "corda/study/study.hpp"

namespace corda::app {

/// The name by which this chapter is asked for, beside those of study::chapter_names().
inline constexpr const char* kPictureChapter = "picture";

/// What the chapter on pictures is about.
struct PictureStudyDef {
    bool quick = false;                 ///< 30 frames of 640x360, once; else 120 of 1280x720, best of five
    std::optional<scene::Scene> scene;  ///< default: the source report's rope as a true chain
};

/// Renders a scene whole, by several solvers against the displayed error, and by several x264 presets against
/// what is lost by encoding. A gl::Context must be current. Throws corda::Error: kInvalidScene where neither
/// of the accurate methods can run the scene, kEncoder, kIo.
[[nodiscard]] study::Chapter picture_chapter(const PictureStudyDef& def, const study::Progress& progress);

}  // namespace corda::app
