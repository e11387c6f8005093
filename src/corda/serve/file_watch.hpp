#pragma once

#include <string>

#include "corda/core/file.hpp"

namespace corda::serve {

/// Notices changes of a file, also by programs that put another file in its place.
class FileWatch {
  public:
    /// Throws corda::Error: kTemporary if the system watches no more files, kIo if there is no such folder.
    explicit FileWatch(const std::string& path);

    /// Waits up to `timeout_ms` for a change of the folder. Whether the file has changed, its time, size and
    /// number tell, also on file systems of other machines, which report nothing.
    [[nodiscard]] bool wait(int timeout_ms);

  private:
    struct Stamp {
        long long seconds = 0;
        long long nanoseconds = 0;
        long long bytes = -1;  ///< -1: there is no file
        unsigned long long number = 0;

        friend bool operator==(const Stamp&, const Stamp&) = default;
    };
    [[nodiscard]] Stamp stamp() const;

    std::string path_;
    Descriptor inotify_;
    Stamp last_;
};

}  // namespace corda::serve
