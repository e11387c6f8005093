#pragma once

#include <mutex>
#include <string>
#include <vector>

#include "corda/media/defs.hpp"

namespace corda::suite {

/// Pictures for a folder that all come at once, or not at all: until publish() they are in a folder of their
/// own inside of it, which goes with this object.
class Staging {
  public:
    /// Makes the folder and its missing parents when the first picture comes.
    explicit Staging(std::string folder);
    Staging(const Staging&) = delete;
    Staging& operator=(const Staging&) = delete;
    ~Staging();

    /// Writes a picture, from any thread. Throws corda::Error (kIo).
    void add(const std::string& name, const Image& image, const PngInfo& info);
    /// Moves all pictures to their names, then removes these files. Throws corda::Error (kIo).
    void publish(const std::vector<std::string>& stale);

  private:
    std::string folder_;
    std::string inside_;  // where pictures wait; empty before the first
    std::mutex mutex_;
    std::vector<std::string> names_;
};

}  // namespace corda::suite
