#pragma once

#include <string>

namespace corda {

/// "nvidia" of "NAME.nvidia.png", a variant of the reference NAME.png; empty if the name has no cause.
[[nodiscard]] std::string variant_cause(const std::string& path);

/// "NAME.png" of "FOLDER/NAME.nvidia.png": the name of the reference that it is a variant of; empty if the
/// name has no cause.
[[nodiscard]] std::string base_of_variant(const std::string& path);

}  // namespace corda
