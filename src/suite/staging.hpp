#pragma once

#include <mutex>
#include <string>
#include <vector>

#include "corda/core/file.hpp"
#include "corda/media/defs.hpp"

namespace corda::suite {

/// Pictures for a folder that come when all are drawn, or not at all: until publish() they are in a folder of
/// their own inside of it, ".update", which goes with this object. From the first picture on the folder is
/// locked, so that an ".update" there is what an update that was killed has left, and is removed.
class Staging {
  public:
    /// Makes the folder and its missing parents when the first picture comes.
    explicit Staging(std::string folder);
    Staging(const Staging&) = delete;
    Staging& operator=(const Staging&) = delete;
    ~Staging();

    /// Writes a picture, from any thread. Throws corda::Error: kIo; kTemporary if another update is at work.
    void add(const std::string& name, const Image& image, const PngInfo& info);
    /// Moves all pictures to their names, then removes these files. Throws corda::Error (kIo).
    void publish(const std::vector<std::string>& stale);

  private:
    /// Locks the folder, and makes the one inside of it.
    void begin();

    std::string folder_;
    Descriptor lock_;
    std::string inside_;  // where pictures wait; empty before the first
    std::mutex mutex_;
    std::vector<std::string> names_;
};

}  // namespace corda::suite
