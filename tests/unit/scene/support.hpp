#pragma once

#include <gmock/gmock.h>

#include <string>
#include <string_view>
#include <vector>

#include "corda/core/basics.hpp"
#include "corda/scene/scene.hpp"

namespace corda::scene {

/// The error of `parse_scene` for a text named "swing.toml".
struct SceneError {
    ExitCode code = ExitCode::kOk;
    std::string message = "no error";
};

inline SceneError error_of(std::string_view toml, const std::vector<Setting>& settings = {}) {
    try {
        static_cast<void>(parse_scene(toml, "swing.toml", settings));
        return {};
    } catch (const Error& error) {
        return {error.code(), error.what()};
    }
}

/// A scene of one short rope, with more text at its end.
inline std::string with(const std::string& more) {
    return "schema = 1\nrope = [{ hang = { links = 3, length = 3.0 } }]\n" + more;
}

/// A scene of one rope of three particles with more keys, from line 4 on.
inline std::string rope_with(const std::string& keys) {
    return "schema = 1\n[[rope]]\nline = { particles = 3, step = [0, -1] }\n" + keys;
}

/// A scene of one rope of four points at the corners of a unit square, with more keys, from line 4 on.
inline std::string square_with(const std::string& keys) {
    return "schema = 1\n[[rope]]\npoints = [[0, 0], [1, 0], [1, 1], [0, 1]]\n" + keys;
}

/// A scene of one net of 3 columns and 2 rows with more keys, from line 4 on.
inline std::string grid_with(const std::string& keys) {
    return "schema = 1\n[[net]]\ngrid = { columns = 3, rows = 2, spacing = 0.5 }\n" + keys;
}

/// A scene of one net of the bars that are given, between four points at the corners of a unit square; more
/// keys from line 5 on.
inline std::string graph_with(const std::string& bars, const std::string& keys = "") {
    return "schema = 1\n[[net]]\npoints = [[0, 0], [1, 0], [1, 1], [0, 1]]\nbars = " + bars + "\n" + keys;
}

}  // namespace corda::scene
