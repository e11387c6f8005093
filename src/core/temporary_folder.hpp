#pragma once

#include <string>

namespace corda {

/// A folder in the system's directory for temporary files, removed with its contents.
class TemporaryFolder {
  public:
    /// Throws corda::Error (kIo) if there is no place for it.
    TemporaryFolder();
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;
    ~TemporaryFolder();

    [[nodiscard]] std::string file(const std::string& name) const { return path_ + "/" + name; }

  private:
    std::string path_;
};

}  // namespace corda
