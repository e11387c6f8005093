#pragma once

#include <string>
#include <string_view>
#include <utility>

#include "corda/core/basics.hpp"
#include "corda/core/file.hpp"

namespace corda {

/// Kinds of destinations of an output.
enum class OutputKind {
    kFile,    ///< an ordinary file, because the writer goes back in it
    kStream,  ///< also a device, a pipe or standard output
};

/// Whoever reads standard output reads no more: the end of the work, and no fault.
class ReaderLeft : public Error {
  public:
    ReaderLeft() : Error(ExitCode::kIo, "standard output was closed by its reader") {}
};

/// Whether `path` names standard output: "-" or "/dev/stdout".
[[nodiscard]] bool is_standard_output(const std::string& path);

/// Refuses an output that cannot be written, before any work is done. Throws corda::Error: kUsage if `path`
/// is the file `input` (empty: there is none) or names no file; kIo if `path` exists and `force` is not set,
/// is a folder, is not of the given kind, or if its folder is missing or cannot be written to.
void check_output(const std::string& path, const std::string& input, bool force,
                  OutputKind kind = OutputKind::kFile);

/// A file that gets its name only when it is complete.
///
/// The bytes go to a temporary file of unique name in the same folder. `commit` flushes it to disk and gives
/// it the final name; a file or a symbolic link that already has this name is replaced only with `force`. A
/// device, a pipe or standard output is written to directly. A killed process leaves "NAME.XXXXXXXX.tmp".
class OutputFile : NonCopyable {
  public:
    struct InMemory {};
    /// A file in memory, which can be read through bytes() and temporary_path() and never gets a name. Throws
    /// corda::Error (kTemporary).
    explicit OutputFile(InMemory);
    /// Creates the temporary file. Throws corda::Error (kIo), like all below.
    explicit OutputFile(std::string path, const OutputOptions& options = {});
    /// Removes the temporary file unless `commit` or `keep` was called.
    ~OutputFile();

    /// Throws ReaderLeft, like all below, if the reader of standard output has closed it.
    void write(std::string_view bytes);

    /// Contents of a file in memory, with those in the buffer of `write`.
    [[nodiscard]] std::string bytes();

    /// Flushes the buffer of `write`, for readers of the file before it has its name.
    void flush();

    /// Changes the final name, which must be in the same folder.
    void rename(std::string path) { path_ = std::move(path); }

    /// Flushes the buffer of `write` and the file to disk, closes it, and gives it its name.
    /// If the name was taken meanwhile, and without `force`, the complete file is kept as by `keep`, and the
    /// message says where.
    void commit();

    /// Closes an unfinished file and leaves it as "PATH.part", or under its temporary name if that one is
    /// taken. Returns where it is.
    std::string keep();

    /// The open file, for libraries that write by themselves. They must not mix with `write`.
    [[nodiscard]] int descriptor() const { return descriptor_.get(); }

    /// Where the bytes are before `commit`; empty for a device, a pipe or standard output.
    [[nodiscard]] const std::string& temporary_path() const { return temporary_; }

  private:
    void open_directly();
    void open_temporary();
    [[noreturn]] void fail_write(int error_number) const;
    void close();
    [[nodiscard]] int rename_to(const std::string& name) const;

    std::string path_;
    std::string temporary_;
    std::string buffer_;
    OutputOptions options_;
    Descriptor descriptor_;
};

/// Writes a whole OutputFile.
void save_file(const std::string& path, std::string_view bytes,
               const OutputOptions& options = {.force = true});

}  // namespace corda
