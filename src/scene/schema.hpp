#pragma once

#include <string>

namespace corda::scene {

/// The keys of scene files as a JSON Schema (draft 7, which TOML editors read): their types, ranges, words,
/// defaults and meanings. It accepts every scene that Corda reads, and refuses unknown keys, missing ones and
/// values out of range; what depends on several keys, such as the solver that a key needs, it leaves to
/// Corda.
[[nodiscard]] std::string json_schema();

}  // namespace corda::scene
