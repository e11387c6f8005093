#pragma once

#include <functional>
#include <string>

#include "corda/core/basics.hpp"

namespace corda::test {

/// The result of some work: kOk, or the corda::Error that it threw.
struct Failure {
    ExitCode code = ExitCode::kOk;
    std::string message;
};

[[nodiscard]] inline Failure failure_of(const std::function<void()>& work) {
    try {
        work();
    } catch (const Error& error) {
        return {error.code(), error.what()};
    }
    return {};
}

/// The code alone.
[[nodiscard]] inline ExitCode code_of(const std::function<void()>& work) {
    return failure_of(work).code;
}

}  // namespace corda::test
