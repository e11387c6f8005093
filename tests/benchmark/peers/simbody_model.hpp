#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace corda::peers {

/// Parts of a Simbody model. Simbody's headers do not compile as C++20, so that this one is
/// the border between them and Corda's.
struct SimbodyDef {
    std::vector<double> x, y, vx, vy, mass;
    std::vector<bool> is_pinned;
    std::vector<std::pair<std::size_t, std::size_t>> bars;
    double rest_m = 0.0;         ///< of every bar
    double stiffness_n_m = 0.0;  ///< of every bar; 0: a chain of rigid links
    double bend_n_m = 0.0;
    double gravity = 0.0;
    double start_angle = 0.0;
};

enum class SimbodyMethod { kMerson, kFehlberg, kVerlet, kCpodesAdams };

class SimbodyModel {
  public:
    SimbodyModel() = default;
    SimbodyModel(const SimbodyModel&) = delete;
    SimbodyModel& operator=(const SimbodyModel&) = delete;
    virtual ~SimbodyModel() = default;
    virtual void step_to(double time_s) = 0;
    /// Writes positions and velocities of the particles that are not pinned.
    virtual void read(std::vector<double>& x, std::vector<double>& y, std::vector<double>& vx,
                      std::vector<double>& vy) = 0;

    static std::unique_ptr<SimbodyModel> make(const SimbodyDef& def, SimbodyMethod method, double accuracy);
    static std::string version();
};

}  // namespace corda::peers
