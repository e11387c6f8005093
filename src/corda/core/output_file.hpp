#pragma once

#include <atomic>
#include <functional>
#include <optional>
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

/// Removes the temporary files that killed processes have left of outputs of this name. Those of living ones
/// are locked, and stay. Never throws: they do no harm.
void remove_leftovers(const std::string& path) noexcept;

/// The same for all outputs in a folder whose names satisfy `is_output`.
void remove_leftovers(const std::string& folder,
                      const std::function<bool(const std::string& name)>& is_output) noexcept;

/// A file that gets its name only when it is complete.
///
/// The bytes go to a temporary file of unique name in the same folder, which is locked. `commit` gives it the
/// final name; a file that already has this name, even one that appeared meanwhile, is replaced only with
/// `force`. Then its permissions stay, and if the name is a symbolic link, the file it leads to is replaced.
/// A device, a pipe or standard output is written to directly.
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
    void rename(std::string path) { path_ = target_ = std::move(path); }

    /// Flushes the buffer of `write` and the file to disk, closes it, and gives it its name.
    /// If the name was taken meanwhile, without `force` by anything, with it by a device or a pipe, the
    /// complete file is kept as by `keep`, and the message says where.
    void commit();

    /// Closes an unfinished file and leaves it as "PATH.part", or under its temporary name if that one is
    /// taken. Returns where it is.
    std::string keep();

    /// The open file, for libraries that write by themselves. They must not mix with `write`.
    [[nodiscard]] int descriptor() const { return descriptor_.get(); }

    /// Where the bytes are before `commit`; empty for a device, a pipe or standard output.
    [[nodiscard]] const std::string& temporary_path() const { return temporary_; }

  private:
    /// The owner and mode of the file that is to be replaced.
    struct Owner {
        unsigned mode;
        unsigned user;
        unsigned group;
    };

    /// Learns what commit() is to replace.
    void find_target();
    void open_directly();
    void open_temporary();
    void restore_permissions();
    [[noreturn]] void fail_write(int error_number) const;
    void close();
    /// A second descriptor, which holds the lock beyond the close: without it, the file would be a leftover
    /// until it has its name.
    [[nodiscard]] Descriptor second_lock() const;
    [[nodiscard]] int rename_to(const std::string& name) const;

    std::string path_;    // as given
    std::string target_;  // the file to replace: behind all symbolic links with `force`
    std::string temporary_;
    std::string buffer_;
    OutputOptions options_;
    std::optional<Owner> replaced_;
    Descriptor descriptor_;
};

/// Writes a whole OutputFile.
void save_file(const std::string& path, std::string_view bytes,
               const OutputOptions& options = {.force = true});

/// Exists while results are saved under their names. A signal lets this be completed: flushing to a slow disk
/// may take seconds. Safe to ask for in a signal handler.
class Saving : NonCopyable {
  public:
    Saving() noexcept { ++count_; }
    ~Saving() { --count_; }

    [[nodiscard]] static bool is_active() noexcept { return count_ > 0; }

  private:
    inline static std::atomic<int> count_{0};
    static_assert(std::atomic<int>::is_always_lock_free);
};

}  // namespace corda
