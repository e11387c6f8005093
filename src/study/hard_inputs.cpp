#include <fmt/format.h>

#include "corda/core/basics.hpp"
#include "corda/scene/scene.hpp"
#include "corda/study/hard_cases.hpp"

namespace corda::study {
namespace {

/// Passes if each of these scenes is refused as invalid.
Outcome refused(const std::vector<std::string>& scenes) {
    std::string message;
    for (const std::string& toml : scenes) {
        try {
            static_cast<void>(parse_scene("schema = 1\n" + toml, "scene.toml"));
            return {fmt::format("read without an error: {}", toml), false};
        } catch (const Error& error) {
            message = error.what();
            if (error.code() != ExitCode::kInvalidScene) return {message, false};
        }
    }
    return {fmt::format("refused, e.g. {}", message), true};
}

}  // namespace

void add_hard_inputs(std::vector<HardCase>& cases) {
    const std::string rope = "[[rope]]\nline = { particles = 5, step = [0.1, -1.0] }\n";
    const std::string stepped = rope + "[solver]\nmethod = \"rattle\"\nstep = ";
    const auto add = [&](const char* name, const std::vector<std::string>& scenes) {
        cases.push_back({name, "all", "refused", false, [scenes] { return refused(scenes); }});
    };
    add("mass 0 of a free particle", {rope + "mass = 0.0\n", rope + "mass = [1.0, 1.0, 0.0, 1.0, 1.0]\n"});
    add("step 0, negative, NaN", {stepped + "0.0\n", stepped + "-0.01\n", stepped + "nan\n"});
    add("coincident particles, rest length 0",
        {"[[rope]]\npoints = [[0.0, 0.0], [0.0, 0.0], [1.0, 0.0]]\n",
         "[[rope]]\npoints = [[0.0, 0.0], [1.0, 0.0]]\nlink_length = 0.0\n"});
}

}  // namespace corda::study
