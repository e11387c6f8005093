#pragma once

#include <CLI/CLI.hpp>

#include <string>

namespace corda::app {

/// The manual page, corda(1), for man: from the commands and options that the program knows.
[[nodiscard]] std::string manual_page(const CLI::App& app);

}  // namespace corda::app
