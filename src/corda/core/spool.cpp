#include "corda/core/spool.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <string>

#include "corda/core/cancel.hpp"
#include "corda/core/exit_code.hpp"
#include "corda/core/text.hpp"

namespace corda {
namespace {

std::string temporary_folder() {
    const char* const chosen = std::getenv("TMPDIR");
    return chosen != nullptr && *chosen != '\0' ? chosen : "/var/tmp";
}

[[noreturn]] void fail_open(std::size_t bytes, int error_number) {
    const ExitCode code = exit_code_of_errno(error_number);
    throw_error(code, "a motion of {:.3g} GiB has no temporary file in '{}': {}; {}",
                static_cast<double>(bytes) / static_cast<double>(1U << 30U), temporary_folder(),
                std::strerror(error_number),
                code == ExitCode::kTemporary
                    ? "try again, or raise the limit (ulimit -n)"
                    : "free some space there, or set TMPDIR to a folder that has it");
}

Descriptor open_nameless(std::size_t bytes) {
    std::string path = temporary_folder() + "/corda.XXXXXX";
    Descriptor file(::mkostemp(path.data(), O_CLOEXEC));
    if (!file) fail_open(bytes, errno);
    ::unlink(path.c_str());
    int error = EINTR;
    while (error == EINTR) {
        check_cancelled();
        error = ::posix_fallocate(file.get(), 0, static_cast<off_t>(bytes));
    }
    if (error != 0) fail_open(bytes, error);
    return file;
}

/// Calls `transfer` with the remaining bytes and their offset in the file until all are transferred.
template <class Byte, class Transfer>
void transfer_all(std::size_t offset, std::span<Byte> bytes, const Transfer& transfer) {
    for (std::size_t done = 0; done < bytes.size();) {
        const ssize_t count =
            transfer(bytes.data() + done, bytes.size() - done, static_cast<off_t>(offset + done));
        if (count > 0)
            done += static_cast<std::size_t>(count);
        else if (count == 0 || errno != EINTR)
            fail_file("use the temporary file of a motion in", temporary_folder(), count == 0 ? EIO : errno);
    }
}

}  // namespace

Spool::Spool(std::size_t capacity, std::size_t max_memory) {
    if (capacity > max_memory / sizeof(double)) {
        file_ = open_nameless(capacity * sizeof(double));
        return;
    }
    values_.reserve(capacity);
}

void Spool::write(std::size_t first, std::span<const double> values) {
    if (file_) {
        transfer_all(first * sizeof(double), std::as_bytes(values),
                     [this](const void* from, std::size_t count, off_t at) {
                         return ::pwrite(file_.get(), from, count, at);
                     });
        return;
    }
    values_.resize(std::max(values_.size(), first + values.size()));
    std::copy(values.begin(), values.end(), values_.begin() + static_cast<std::ptrdiff_t>(first));
}

void Spool::read(std::size_t first, std::span<double> values) const {
    if (file_) {
        transfer_all(
            first * sizeof(double), std::as_writable_bytes(values),
            [this](void* to, std::size_t count, off_t at) { return ::pread(file_.get(), to, count, at); });
        return;
    }
    std::copy_n(values_.begin() + static_cast<std::ptrdiff_t>(first), values.size(), values.begin());
}

}  // namespace corda
