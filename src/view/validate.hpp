#pragma once

#include <string>
#include <vector>

#include "corda/view/defs.hpp"

namespace corda::view {

// Definitions that are filled in code have not been checked by the reader of scene files. Each function
// throws corda::Error (kInvalidScene) for a field that is outside the range of its declaration.

void validate(const StyleDef& style, const std::vector<BodyStyleDef>& body_styles);
void validate(const OverlayDef& overlay);
void validate(const CameraDef& camera);

/// Why a text cannot be shown: "the font, DejaVu Sans, has no U+1F9F6; leave that character out". Empty if it
/// can.
[[nodiscard]] std::string missing_glyph(const std::string& text);

}  // namespace corda::view
