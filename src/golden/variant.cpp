#include "corda/golden/variant.hpp"

#include <filesystem>

namespace corda {
namespace fs = std::filesystem;

std::string variant_cause(const std::string& path) {
    const std::string cause = fs::path(path).stem().extension().string();
    return cause.empty() ? "" : cause.substr(1);
}

std::string base_of_variant(const std::string& path) {
    if (variant_cause(path).empty()) return "";
    const fs::path file = fs::path(path).filename();
    return file.stem().stem().string() + file.extension().string();
}

}  // namespace corda
