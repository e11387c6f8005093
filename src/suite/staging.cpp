#include "corda/suite/staging.hpp"

#include <fcntl.h>
#include <sys/file.h>

#include <fmt/format.h>

#include <cerrno>
#include <filesystem>
#include <utility>

namespace corda::suite {
namespace {

namespace fs = std::filesystem;

}  // namespace

Staging::Staging(std::string folder) : folder_(std::move(folder)) {}

Staging::~Staging() {
    std::error_code ignored;
    if (!inside_.empty()) fs::remove_all(inside_, ignored);
}

void Staging::begin() {
    make_folder(folder_);
    lock_ = Descriptor(::open(folder_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
    if (!lock_) fail_file("open", folder_, errno);
    // A file system without locks has no other update to find either.
    if (::flock(lock_.get(), LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK)
        throw Error(ExitCode::kTemporary,
                    fmt::format("another update is writing to '{}'; try again when it has ended", folder_));
    const std::string inside = (fs::path(folder_) / ".update").string();
    std::error_code failure;
    fs::remove_all(inside, failure);  // of an update that was killed
    if (failure) fail_file("remove", inside, failure.value());
    make_folder(inside);
    inside_ = inside;
}

void Staging::add(const std::string& name, const Image& image, const PngInfo& info) {
    {
        const std::lock_guard lock(mutex_);
        if (inside_.empty()) begin();
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
