#include "corda/core/temporary_folder.hpp"

#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <system_error>

#include "corda/core/basics.hpp"

namespace corda {

TemporaryFolder::TemporaryFolder() {
    std::error_code failure;
    path_ = (std::filesystem::temp_directory_path(failure) / "corda-XXXXXX").string();
    if (!failure && mkdtemp(path_.data()) == nullptr) failure.assign(errno, std::generic_category());
    if (failure)
        throw Error(ExitCode::kIo, "cannot make a folder for temporary files, '" + path_ + "': " +
                                       failure.message() + "; set TMPDIR to a folder that can be written to");
}

TemporaryFolder::~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
}

}  // namespace corda
