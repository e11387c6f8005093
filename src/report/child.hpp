#pragma once

#include <string>
#include <vector>

namespace corda::report {

/// Exit status and output of a finished program.
struct ChildResult {
    int exit_code = -1;  ///< 128 + the number of the signal if one ended it
    std::string out;
    std::string err;
};

/// Runs a program found in PATH with `input` on its standard input, and waits for it. No shell is involved.
/// Its time zone is UTC. It does not outlive this process or the calling thread. Throws corda::Error if it
/// cannot be started: kTemporary for want of processes or memory, else kIo, which ends with `hint`.
[[nodiscard]] ChildResult run_child(const std::vector<std::string>& command, const std::string& input,
                                    const std::string& hint);

}  // namespace corda::report
