#pragma once

#include <toml++/toml.h>

#include "corda/scene/problems.hpp"
#include "corda/scene/scene.hpp"

namespace corda::scene {

/// Puts `setting` into the document, making missing tables on its way. What it puts there has the setting
/// itself as its source, so that messages about it name the setting. One that does not fit the document is a
/// problem. Throws corda::Error (kUsage) if it is not key=value.
void apply_setting(toml::table& document, const Setting& setting, Problems& problems);

}  // namespace corda::scene
