#pragma once

#include <string>
#include <vector>

namespace corda::study {

/// What a finished program left behind.
struct ChildResult {
    int exit_code = -1;  ///< 128 + the signal where one ended it
    std::string out;
    std::string err;
};

/// Runs a program out of PATH with `input` on its standard input and waits for it. No shell is involved.
/// Throws corda::Error (kIo), saying `hint`, where it cannot be started.
[[nodiscard]] ChildResult run_child(const std::vector<std::string>& command, const std::string& input,
                                    const std::string& hint);

}  // namespace corda::study
