#pragma once

#include <string>

#include "corda/sweep/sweep_file.hpp"
#include "support/command.hpp"

namespace corda::sweep {

/// A scene that takes milliseconds.
inline const std::string kScene = R"(schema = 1
[world]
duration = 0.1
[[rope]]
hang = { links = 2, length = 1.0, angle_deg = 40.0 }
[solver]
method = "exact"
[video]
size = [32, 32]
fps = 30
)";

/// A folder with "scene.toml".
class SweepFolder {
  public:
    explicit SweepFolder(const std::string& scene = kScene) {
        static_cast<void>(folder_.write("scene.toml", scene));
    }

    /// A sweep file of the scene with more text, from line 3 on.
    [[nodiscard]] SweepDef load(const std::string& more) const {
        return load_sweep(folder_.write("sweep.toml", "schema = 1\nscene = \"scene.toml\"\n" + more));
    }
    [[nodiscard]] std::string file(const std::string& name) const { return folder_.file(name); }

  private:
    test::ScratchFolder folder_;
};

}  // namespace corda::sweep
