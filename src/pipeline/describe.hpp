#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "corda/core/basics.hpp"
#include "corda/media/defs.hpp"
#include "corda/sim/simulation.hpp"
#include "corda/sim/system.hpp"
#include "corda/sim/validate.hpp"

namespace corda {

/// What a scene amounts to: "40 particles, 252 bars (39 real)".
[[nodiscard]] std::string describe(const System& system);

/// A method in words: "exact at tolerance 1e-08".
[[nodiscard]] std::string describe(const MethodDef& method);

/// Why a body is moved by its method, as a clause.
[[nodiscard]] std::string describe(const BodyPlan& plan);

/// Bodies that the same method moves for the same reason.
struct MethodGroup {
    MethodDef method;
    std::vector<std::size_t> bodies;  ///< indices in Plan::bodies, ascending
};

/// All bodies of a plan; groups in the order of their first bodies.
[[nodiscard]] std::vector<MethodGroup> groups_of(const Plan& plan);

/// Their names: "ropes 0 to 3, net 1".
[[nodiscard]] std::string describe(const System& system, const std::vector<std::size_t>& bodies);

/// The methods in words, with the bodies of each if there are several: "exact at tolerance 1e-05 (rope 0);
/// rattle of order 4, step 0.004 s (net 0)".
[[nodiscard]] std::string describe(const System& system, const Plan& plan);

/// The methods' names: "exact, rattle".
[[nodiscard]] std::string method_names(const Plan& plan);

/// What a picture file of a scene says of itself: program, scene, time in s, if it is not empty, frame, and
/// what it was made from (provenance_text).
[[nodiscard]] PngInfo picture_info(const std::string& scene_name, const std::string& times,
                                   const std::string& frames, const std::string& provenance);

/// The same with the bound of the displayed error: "exact, error below 0.031 px".
[[nodiscard]] std::string method_caption(const Plan& plan, const std::optional<double>& error_bound_px);

namespace pipeline {

/// The refusal of a scene: names its file (Scene::source), the problem, and which keys to change.
[[nodiscard]] Error explained(const Refusal& refusal, const std::string& source);

}  // namespace pipeline
}  // namespace corda
