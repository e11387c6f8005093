#pragma once

#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "corda/core/basics.hpp"
#include "corda/film/film.hpp"
#include "corda/media/defs.hpp"
#include "corda/sim/simulation.hpp"
#include "corda/sim/system.hpp"
#include "corda/view/defs.hpp"

namespace corda {

/// The method of a body as the plan names it: "given" if its positions are.
[[nodiscard]] std::string_view method_name(const BodyPlan& plan);
/// The same with its settings: "exact at tolerance 1e-05".
[[nodiscard]] std::string method_text(const BodyPlan& plan);

/// Size of a system: "40 particles, 252 bars (39 real)".
[[nodiscard]] std::string system_text(const System& system);

/// The reason for a body's method, as a clause.
[[nodiscard]] std::string reason_text(const BodyPlan& plan);

/// The reason for the horizon of a body; std::nullopt if it has none.
[[nodiscard]] std::optional<std::string> horizon_reason(const BodyPlan& plan);

/// Why a net never moves and what would let it; std::nullopt if it may. `is_alone`: the scene has no other
/// body.
[[nodiscard]] std::optional<std::string> still_text(const BodyPlan& plan, bool is_alone);

/// Why the tensions of a body that this plan moves are unknown, and what would make them known.
[[nodiscard]] std::string unknown_tensions_text(const BodyPlan& plan);

/// Bodies with the same method for the same reason.
struct MethodGroup {
    MethodDef method;
    std::vector<std::size_t> bodies;  ///< indices in Plan::bodies, ascending
};

/// All bodies of a plan; groups in the order of their first bodies.
[[nodiscard]] std::vector<MethodGroup> groups_of(const Plan& plan);

/// Names of bodies: "ropes 0 to 3, net 1".
[[nodiscard]] std::string bodies_text(const System& system, const std::vector<std::size_t>& bodies);

/// The methods, with the bodies of each if there are several: "exact at tolerance 1e-05 (rope 0); rattle of
/// order 4, step 0.004 s (net 0)".
[[nodiscard]] std::string plan_text(const System& system, const Plan& plan);

/// The methods' names: "exact, rattle".
[[nodiscard]] std::string method_names(const Plan& plan);

/// The methods' names with the estimate of the displayed error: "exact, error below 0.031 px".
[[nodiscard]] std::string method_caption(const Plan& plan, const std::optional<double>& error_estimate_px,
                                         Language language);

/// The terms of the model, one per line. Omits terms that the scene does not ask for.
[[nodiscard]] std::vector<std::string> modelled_terms(const Scene& scene, const Plan& plan);

/// The error estimate of all bodies that have one: "0.06 px, 0.0003 m, up to 0.75 s, except net 1";
/// std::nullopt if none has one, or if predictability ends at the start.
[[nodiscard]] std::optional<std::string> error_estimate_text(const Film& film);

/// The texts of a picture file: program, scene, times in s, frames unless empty, and provenance
/// (provenance_text).
[[nodiscard]] PngInfo picture_info(const std::string& scene_name, const std::string& times,
                                   const std::string& frames, const std::string& provenance);

/// A value in JSON, or null if there is none.
[[nodiscard]] nlohmann::json or_null(const std::optional<double>& value);
[[nodiscard]] nlohmann::json or_null(const std::optional<std::string>& value);

namespace film {

/// The refusal of a scene as an error that names its file (Scene::source), the problem, and the keys to
/// change.
[[nodiscard]] Error explained(const Refusal& refusal, const Scene& scene);

}  // namespace film
}  // namespace corda
