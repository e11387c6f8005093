#pragma once

#include <optional>
#include <string>
#include <vector>

#include "corda/pipeline/film.hpp"

namespace corda {

/// What is modelled, a line per term: what a scene does not ask for is left out.
[[nodiscard]] std::vector<std::string> modelled_terms(const Scene& scene, const Plan& plan);

/// The bound on the error of all bodies that have one: "0.06 px, 0.0003 m, up to 0.75 s, but for net 1";
/// std::nullopt if none has, or if predictability ends at the start.
[[nodiscard]] std::optional<std::string> bound_text(Film& film);

}  // namespace corda
