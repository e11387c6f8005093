#include "corda/suite/staging.hpp"

#include <unistd.h>

#include <fmt/format.h>

#include <filesystem>
#include <utility>

#include "corda/core/file.hpp"

namespace corda::suite {
namespace {

namespace fs = std::filesystem;

}  // namespace

Staging::Staging(std::string folder) : folder_(std::move(folder)) {}

Staging::~Staging() {
    std::error_code ignored;
    if (!inside_.empty()) fs::remove_all(inside_, ignored);
}

void Staging::add(const std::string& name, const Image& image, const PngInfo& info) {
    {
        const std::lock_guard lock(mutex_);
        if (inside_.empty()) {
            inside_ = (fs::path(folder_) / fmt::format(".update_{}", getpid())).string();
            make_folder(inside_);
        }
        names_.push_back(name);
    }
    write_png((fs::path(inside_) / name).string(), image, info, {.force = true});
}

void Staging::publish(const std::vector<std::string>& stale) {
    std::error_code failure;
    for (const std::string& name : names_) {
        const std::string path = (fs::path(folder_) / name).string();
        fs::rename(fs::path(inside_) / name, path, failure);
        if (failure) fail_file("write", path, failure.value());
    }
    for (const std::string& path : stale) {
        fs::remove(path, failure);
        if (failure) fail_file("remove", path, failure.value());
    }
    if (!names_.empty() || !stale.empty()) sync_folder_of((fs::path(folder_) / "any").string());
}

}  // namespace corda::suite
