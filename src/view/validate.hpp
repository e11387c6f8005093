#pragma once

#include <vector>

#include "corda/view/defs.hpp"

namespace corda::view {

// Definitions that are filled in code have not been checked by the reader of scene files. Each function
// throws corda::Error (kInvalidScene) for a field that is outside the range of its declaration.

void validate(const StyleDef& style, const std::vector<BodyStyleDef>& body_styles);
void validate(const OverlayDef& overlay);
void validate(const CameraDef& camera);

}  // namespace corda::view
