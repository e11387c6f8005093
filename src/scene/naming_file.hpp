#pragma once

#include <string_view>

#include "corda/core/error.hpp"
#include "corda/scene/scene.hpp"

namespace corda::scene {

/// What `make` returns. Where a solver refuses the scene, which knows no files, the error names the scene's.
template <class Make>
auto naming_file(const Scene& scene, const Make& make) -> decltype(make()) {
    try {
        return make();
    } catch (const Error& error) {
        const bool is_named =
            scene.source.empty() || std::string_view(error.what()).starts_with(scene.source);
        if (error.code() != ExitCode::kInvalidScene || is_named) throw;
        throw Error(error.code(), scene.source + ": " + error.what());
    }
}

}  // namespace corda::scene
