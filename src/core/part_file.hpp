#pragma once

#include <string>

#include "corda/core/basics.hpp"
#include "corda/core/file.hpp"

namespace corda {

/// The name of the unfinished file of `path`.
[[nodiscard]] inline std::string part_path(const std::string& path) {
    return path + ".part";
}

/// The name of the copy of a part that a resumed render makes, and which then takes its place.
[[nodiscard]] inline std::string part_copy_path(const std::string& part) {
    return part + ".new";
}

/// The file that holds an unfinished video under a name that can be guessed, so that it is found again after
/// a crash. It is locked while the object lives: two renders never write to one part.
///
/// Whoever removes or replaces a part holds its lock, and a lock counts only while the name still leads to
/// the locked file. A symbolic link under the name is never followed.
class PartFile {
  public:
    /// Throws corda::Error (kIo) if a part file is in the way: with `force`, only one that another process
    /// holds. An empty one is replaced: its process was killed before it finished a chunk.
    /// Anything but an ordinary file is refused in any case, here and below, and stays.
    static void check(const std::string& path, const OutputOptions& options);

    /// Creates the part file, in place of an empty one or, with `force`, of any. Throws as `check`, and if it
    /// cannot be made.
    [[nodiscard]] static PartFile create(std::string path, const OutputOptions& options);

    /// Removes a file unless another process holds it, or might: on a file system without locks.
    static void remove_unheld(const std::string& path) noexcept;

    /// Locks the part file that an earlier run left. Throws corda::Error (kIo).
    [[nodiscard]] static PartFile open(std::string path);

    [[nodiscard]] const std::string& path() const { return path_; }
    [[nodiscard]] int descriptor() const { return descriptor_.get(); }

    /// Gives this file the name of another part, which it replaces. Throws corda::Error (kIo).
    void take_place_of(PartFile& other);

    /// Whether no byte was written yet.
    [[nodiscard]] bool is_empty() const;

    /// Whether its name still leads to this file: it or its folder may have been removed.
    [[nodiscard]] bool is_named() const;

    /// Flushes the file and its name to disk. Throws corda::Error (kIo).
    void sync();

    /// Removes the file and releases the lock; never throws, because an old part does no harm.
    void remove() noexcept;

  private:
    PartFile(std::string path, Descriptor descriptor);

    std::string path_;
    Descriptor descriptor_;
    bool has_durable_name_ = false;
};

}  // namespace corda
