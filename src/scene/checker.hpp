#pragma once

#include <toml++/toml.h>

#include "corda/scene/problems.hpp"

namespace corda::scene {

/// Holds a document against the list of keys (keys.hpp): unknown and missing keys, types, ranges and keys of
/// other methods. Bad values are taken out of the document, so that their defaults stand in for them.
void check_document(toml::table& document, Problems& problems);

}  // namespace corda::scene
