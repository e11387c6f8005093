#pragma once

#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "corda/golden/update_folder.hpp"
#include "corda/media/defs.hpp"

namespace corda::golden {

/// Pictures for a folder that are published when all are drawn, or not at all. Until publish() they are in an
/// UpdateFolder, which is removed with this object.
class Staging {
  public:
    /// The folder and its missing parents are made with the first picture.
    explicit Staging(std::string folder);
    Staging(const Staging&) = delete;
    Staging& operator=(const Staging&) = delete;
    ~Staging();

    /// Stages a picture, from any thread. Throws corda::Error: kIo; kTemporary if another update is at work.
    void add(const std::string& name, const Image& image, const PngInfo& info);
    /// Moves all pictures to their names, and removes these files of the folder. Throws corda::Error (kIo)
    /// with all pictures as they were, or saying that they are not.
    void publish(const std::vector<std::string>& stale);

  private:
    void begin();

    std::string folder_;
    std::optional<UpdateFolder> inside_;
    std::mutex mutex_;
    std::vector<std::string> names_;
};

}  // namespace corda::golden
