#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "corda/view/scene_view.hpp"

namespace corda::view {

/// The label of a body, next to one of its particles.
struct BodyLabel {
    std::string text;
    std::size_t particle = 0;
    /// The label continues the line from this particle; if it is `particle`, the label is above it.
    std::size_t from = 0;
    double clear_px = 0.0;  ///< free distance around the particle
    int row = 0;            ///< above other labels of the same place
};

/// The labels of bodies that have one: where its style says, else above its first pin, unless another
/// label's body is pinned there too, at its free end, or above its first particle. Several above one pin
/// are in rows.
[[nodiscard]] std::vector<BodyLabel> body_labels(const SceneView& view);

/// A label of a particle: beyond the end of a rope, otherwise above it.
[[nodiscard]] BodyLabel label_at(const SceneView& view, std::size_t particle, std::string text);

}  // namespace corda::view
