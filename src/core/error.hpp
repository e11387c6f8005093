#pragma once

#include <stdexcept>
#include <string>

#include "corda/core/exit_code.hpp"

namespace corda {

/// Bad input or a bad environment. The message says what failed, the value, the library's own reason and one
/// hint; `code` is the status that the program exits with. A programmer's error is an assert instead, and a
/// physical outcome a returned status.
class Error : public std::runtime_error {
  public:
    Error(ExitCode code, const std::string& message) : std::runtime_error(message), code_(code) {}

    [[nodiscard]] ExitCode code() const noexcept { return code_; }

  private:
    ExitCode code_;
};

}  // namespace corda
