#include "study_inputs.hpp"

#include <string>

#include <fmt/format.h>

#include "corda/core/error.hpp"
#include "corda/scene/scene.hpp"

namespace corda::app {
namespace {

/// Held where the reader refuses each of these scenes, with the words for the last.
study::Outcome refused(const std::vector<std::string>& scenes) {
    std::string words;
    for (const std::string& toml : scenes) {
        try {
            static_cast<void>(scene::parse_scene("schema = 1\n" + toml, "scene.toml"));
            return {fmt::format("read without an error: {}", toml), false};
        } catch (const Error& error) {
            if (error.code() != ExitCode::kInvalidScene) return {error.what(), false};
            words = error.what();
        }
    }
    return {fmt::format("refused, e.g. {}", words), true};
}

}  // namespace

std::vector<study::HardCase> input_cases() {
    const std::string rope = "[[rope]]\nline = { particles = 5, step = [0.1, -1.0] }\n";
    const auto with_step = [rope](const std::string& step) {
        return rope + "[solver]\nmethod = \"rope\"\nstep = " + step + "\n";
    };
    return {{"mass 0 of a free particle", "all", "refused", false,
             [=] {
                 return refused({rope + "mass = 0.0\n", rope + "mass = [1.0, 1.0, 0.0, 1.0, 1.0]\n"});
             }},
            {"step 0, negative, NaN", "all", "refused", false,
             [=] {
                 return refused({with_step("0.0"), with_step("-0.01"), with_step("nan")});
             }},
            {"coincident particles, rest length 0", "all", "refused", false, [] {
                 return refused({"[[rope]]\npoints = [[0.0, 0.0], [0.0, 0.0], [1.0, 0.0]]\n",
                                 "[[rope]]\npoints = [[0.0, 0.0], [1.0, 0.0]]\nlink_length = 0.0\n"});
             }}};
}

}  // namespace corda::app
