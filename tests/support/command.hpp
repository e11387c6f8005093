#pragma once

#include <string>
#include <vector>

namespace corda::test {

/// Exit code and output of a command.
struct CommandResult {
    int exit_code = -1;  ///< 128 + the signal if a signal ended it
    std::string out;
    std::string err;
};

/// Runs a command with bash and waits for it.
[[nodiscard]] CommandResult run_shell(const std::string& command);

/// Commands for bash that wait until `condition`, a command, succeeds or process $pid has ended. bash may
/// have reaped it by then, and another process may take its number: so it is asked each time whether it is
/// there.
[[nodiscard]] std::string wait_until(const std::string& condition);
/// The same until the process has a handler for SIGINT.
[[nodiscard]] std::string wait_until_listening();

/// `text` quoted as one word of a shell command.
[[nodiscard]] std::string quoted(const std::string& text);

/// Runs the corda program that was built with the tests; `environment` is put before it, e.g.
/// "LP_NUM_THREADS=1".
[[nodiscard]] CommandResult run_corda(const std::vector<std::string>& arguments,
                                      const std::string& environment = "");

/// A folder for one test, removed with everything in it.
class ScratchFolder {
  public:
    ScratchFolder();
    ScratchFolder(const ScratchFolder&) = delete;
    ScratchFolder& operator=(const ScratchFolder&) = delete;
    ~ScratchFolder();

    [[nodiscard]] std::string file(const std::string& name) const { return path_ + "/" + name; }
    [[nodiscard]] const std::string& path() const { return path_; }
    /// Writes a file and returns its path.
    [[nodiscard]] std::string write(const std::string& name, const std::string& text) const;
    /// Names of the files in it, sorted.
    [[nodiscard]] std::vector<std::string> files() const;

  private:
    std::string path_;
};

/// Writes a file's bytes.
void write_file(const std::string& path, const std::string& bytes);

/// The bytes of a file; empty if there is no such file.
[[nodiscard]] std::string read_file(const std::string& path);

}  // namespace corda::test
