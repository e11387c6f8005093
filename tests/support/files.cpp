#include "support/files.hpp"

#include <algorithm>
#include <cctype>
#include <filesystem>

namespace corda::test {

namespace fs = std::filesystem;

std::vector<std::string> list_files(const std::string& folder, const std::string& ending) {
    std::vector<std::string> paths;
    for (const auto& entry : fs::directory_iterator(folder)) {
        if (entry.path().extension() == ending) paths.push_back(entry.path().string());
    }
    std::sort(paths.begin(), paths.end());
    return paths;
}

std::string test_name(const std::string& path) {
    std::string name = fs::path(path).stem().string();
    for (char& c : name) c = std::isalnum(static_cast<unsigned char>(c)) != 0 ? c : '_';
    return name;
}

}  // namespace corda::test
