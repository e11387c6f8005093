#include "output.hpp"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <utility>

#include <fmt/format.h>

#include "corda/core/error.hpp"

namespace corda::app {

namespace fs = std::filesystem;

void check_output(const std::string& path, const std::string& input, bool force) {
    std::error_code ignored;
    const fs::path folder = fs::path(path).has_parent_path() ? fs::path(path).parent_path() : fs::path(".");
    if (!fs::is_directory(folder, ignored)) {
        throw Error(ExitCode::kIo,
                    fmt::format("{}: the folder {} does not exist; make it first", path, folder.string()));
    }
    const fs::file_status status = fs::status(path, ignored);
    if (!fs::exists(status)) return;
    if (!fs::is_regular_file(status)) {
        throw Error(ExitCode::kIo,
                    fmt::format("{}: exists and is no ordinary file; choose another name", path));
    }
    if (!input.empty() && fs::equivalent(path, input, ignored)) {
        throw Error(ExitCode::kUsage,
                    fmt::format("{}: the output would replace the input; choose another name", path));
    }
    if (!force) throw Error(ExitCode::kIo, fmt::format("{}: exists; give --force to replace it", path));
}

void make_folder(const std::string& path) {
    std::error_code reason;
    fs::create_directories(path, reason);
    if (reason)
        throw Error(ExitCode::kIo, fmt::format("{}: cannot make the folder: {}", path, reason.message()));
}

TextOutput::TextOutput(std::string path)
    : path_(std::move(path)), part_path_(path_ == "-" ? path_ : path_ + ".part") {
    if (path_ == "-") return;
    file_.reset(std::fopen(part_path_.c_str(), "we"));
    if (!file_) fail("opening");
}

void TextOutput::fail(const char* action) const {
    throw Error(ExitCode::kIo, fmt::format("{}: {} failed: {}", part_path_, action, std::strerror(errno)));
}

void TextOutput::write(const std::string& text) {
    std::FILE* const file = file_ ? file_.get() : stdout;
    if (std::fwrite(text.data(), 1, text.size(), file) != text.size()) fail("writing");
}

void TextOutput::finish() {
    if (!file_) {
        if (std::fflush(stdout) != 0) fail("writing");
        return;
    }
    if (std::fclose(file_.release()) != 0) fail("closing");
    std::error_code reason;
    fs::rename(part_path_, path_, reason);
    if (reason)
        throw Error(ExitCode::kIo,
                    fmt::format("{}: cannot be renamed to {}: {}", part_path_, path_, reason.message()));
}

}  // namespace corda::app
