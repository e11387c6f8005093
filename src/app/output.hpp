#pragma once

#include <cstdio>
#include <memory>
#include <string>

namespace corda::app {

/// Refuses an output that cannot be written, before any work is done: throws corda::Error (kIo) where `path`
/// exists and `force` is not set, where it is no ordinary file, or where its folder is missing, and (kUsage)
/// where it is the input file itself.
void check_output(const std::string& path, const std::string& input, bool force);

/// Makes a folder and those above it. Throws corda::Error (kIo).
void make_folder(const std::string& path);

/// A text file that gets its name only when it is whole: it is written as `PATH.part`.
class TextOutput {
  public:
    /// `path` "-" is standard output. Throws corda::Error (kIo), like all below.
    explicit TextOutput(std::string path);

    void write(const std::string& text);
    /// Closes and renames to the final name.
    void finish();
    /// Where the text is while it is not finished.
    [[nodiscard]] const std::string& part_path() const { return part_path_; }

  private:
    struct Closer {
        void operator()(std::FILE* file) const { std::fclose(file); }
    };

    [[noreturn]] void fail(const char* action) const;

    std::string path_;
    std::string part_path_;
    std::unique_ptr<std::FILE, Closer> file_;  // empty for standard output
};

}  // namespace corda::app
