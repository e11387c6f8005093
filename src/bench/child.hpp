#pragma once

#include <functional>
#include <string>

#include <nlohmann/json.hpp>

namespace corda::bench {

/// A folder for videos, removed with them.
class ScratchFolder {
  public:
    ScratchFolder();
    ScratchFolder(const ScratchFolder&) = delete;
    ScratchFolder& operator=(const ScratchFolder&) = delete;
    ~ScratchFolder();

    [[nodiscard]] std::string file(const std::string& name) const { return path_ + "/" + name; }

  private:
    std::string path_;
};

/// What `work` returns, from a child process, which has a peak of memory of its own. `on_wait` is called at
/// least ten times a second; what it throws ends the child. Throws corda::Error: what `work` throws;
/// kTemporary if the child cannot be started or is ended from outside.
[[nodiscard]] nlohmann::json in_child(const std::function<void()>& on_wait,
                                      const std::function<nlohmann::json()>& work);

}  // namespace corda::bench
