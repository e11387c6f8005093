#pragma once

#include <toml++/toml.h>

#include "corda/scene/scene.hpp"

namespace corda::scene {

/// Puts `setting` into the document; missing tables on its way are made. What it puts there has the setting
/// itself as its source, so that messages about it name the setting. Throws kUsage for one that is not
/// key=value, kInvalidScene for one that does not fit the document.
void apply_setting(toml::table& document, const Setting& setting);

}  // namespace corda::scene
