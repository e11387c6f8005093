#pragma once

#include <cstdint>
#include <exception>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "corda/sweep/sample.hpp"

struct archive;

namespace corda::sweep {

using WriteBytes = std::function<void(std::string_view bytes)>;

/// Writes a tar (POSIX ustar) by libarchive. All entries are ordinary files of user 0, mode 0644 and time 0,
/// so that the same entries give the same bytes. Throws corda::Error (kIo, kTemporary), and what `write`
/// throws.
class TarWriter {
  public:
    /// `write` is given the bytes.
    explicit TarWriter(WriteBytes write);
    TarWriter(const TarWriter&) = delete;
    TarWriter& operator=(const TarWriter&) = delete;
    ~TarWriter();

    void add(const std::string& name, std::string_view bytes);
    void finish();

  private:
    struct Free {
        void operator()(archive* its) const;
    };
    void check(int status);
    static std::ptrdiff_t write(archive*, void* writer, const void* bytes, std::size_t count);

    WriteBytes write_;
    std::exception_ptr failure_;  ///< of write_
    std::unique_ptr<archive, Free> archive_;
};

/// Calls `take` with the name and the size of each entry of a tar. Throws corda::Error: kMismatch with the
/// reason if it is damaged, kIo.
void list_tar(const std::string& path, const std::function<void(const std::string&, std::int64_t)>& take);

/// Arrays as numpy.load() reads them from an .npz file. Those of bytes are compressed. Throws corda::Error:
/// kUsage if they are over 4 GiB, kTemporary.
[[nodiscard]] std::string npz_bytes(const std::vector<Array>& arrays);

}  // namespace corda::sweep
