#include "corda/golden/staging.hpp"

#include <filesystem>
#include <utility>

namespace corda::golden {

Staging::Staging(std::string folder) : folder_(std::move(folder)) {}

Staging::~Staging() {
    if (inside_) inside_->remove();
}

void Staging::begin() {
    make_folder(folder_);
    inside_.emplace(UpdateFolder::create(folder_));
}

void Staging::add(const std::string& name, const Image& image, const PngInfo& info) {
    {
        const std::lock_guard lock(mutex_);
        if (!inside_) begin();
        names_.push_back(name);
    }
    write_png(inside_->staged(name), image, info, {.force = true});
}

void Staging::publish(const std::vector<std::string>& stale) {
    if (names_.empty() && stale.empty()) return;
    if (!inside_) begin();
    std::vector<std::string> removed;
    for (const std::string& path : stale) removed.push_back(std::filesystem::path(path).filename().string());
    inside_->publish(names_, removed);
}

}  // namespace corda::golden
