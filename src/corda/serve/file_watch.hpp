#pragma once

#include <array>
#include <string>

#include "corda/core/file.hpp"

namespace corda::serve {

/// Notices changes of a file, also by programs that put another file in its place.
class FileWatch {
  public:
    /// Throws corda::Error (kIo) if there is no such folder.
    explicit FileWatch(const std::string& path);

    /// Why changes are noticed without a report of the system, some 0.1 s later; empty if it reports them.
    [[nodiscard]] const std::string& warning() const { return warning_; }

    /// Waits up to `timeout_ms` or 200 ms for a change of the folder. Whether the file has changed, its
    /// times, size and number tell, also on file systems of other machines, which report nothing. The time of
    /// change tells a save with the old time and size, which an editor or `cp -p` may give it.
    [[nodiscard]] bool wait(int timeout_ms);

  private:
    static constexpr int kLookMs = 200;

    struct Stamp {
        std::array<long long, 2> modified{};  ///< seconds and nanoseconds
        std::array<long long, 2> changed{};
        long long bytes = -1;  ///< -1: there is no file
        unsigned long long number = 0;

        friend bool operator==(const Stamp&, const Stamp&) = default;
    };
    [[nodiscard]] Stamp stamp() const;

    std::string path_;
    Descriptor inotify_;
    std::string warning_;
    Stamp last_;
};

}  // namespace corda::serve
