#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "corda/sim/forces/forces.hpp"
#include "corda/sim/simulation.hpp"
#include "corda/sim/system.hpp"

namespace corda::sim {

/// The x and the y of all particles, in one array each.
template <class Number>
struct Components {
    Number* x;
    Number* y;
};

/// A bar that stretches.
struct Spring {
    std::size_t bar = 0;  ///< of the system
    std::uint32_t a = 0;
    std::uint32_t b = 0;  ///< > a
    double rest_m = 0.0;
    double stiffness_n_m = 0.0;    ///< 1 / (C l)
    double least_stretch_m = 0.0;  ///< lower bound on d - l: 0 for a string, otherwise none
};

/// Springs that join successive particles `a`, a + 1, .. to successive ones `b`, b + 1, ..
struct Strip {
    std::uint32_t a = 0;
    std::uint32_t b = 0;
    std::uint32_t count = 0;
};

/// The members of many springs, in an array each.
struct Springs {
    /// Number of springs whose forces are computed together.
    static constexpr std::size_t kChunk = 64;

    std::vector<std::size_t> bar;
    std::vector<std::uint32_t> a;
    std::vector<std::uint32_t> b;
    std::vector<double> rest_m;
    std::vector<double> stiffness_n_m;
    std::vector<double> least_stretch_m;
    std::vector<Strip> strips;  ///< of all, in their order; none is in two chunks

    void add(const Spring& spring);
    /// d - l of a spring, or its lower bound.
    [[nodiscard]] double stretch_m(std::size_t k, const double* x_m, const double* y_m) const;
};

/// The conservative forces of bars that stretch and of ropes that resist bending, in Cartesian coordinates
/// (section 3.2 of src/corda/sim/README.md). A bar of length 0 has no direction: it exerts no force, and no
/// bend acts at its ends.
///
/// Positions and forces are arrays with one entry per particle, from the first one on.
class ElasticForces {
  public:
    /// Of the bars of stretching bodies and of all bends among the particles `first_particle` ..
    /// `first_particle + particle_count - 1` of the system, which are whole bodies. Bars and bends that join
    /// pinned particles alone never move and are left out, as are those that are gone at its start.
    ElasticForces(const System& system, std::size_t first_particle, std::size_t particle_count);

    [[nodiscard]] bool empty() const { return springs_.bar.empty() && joints_.empty(); }

    /// Adds the forces at these positions to `force_n`, those on pinned particles too. Returns a bound
    /// on the square of the largest angular frequency of small motions about the positions, 1 / s^2:
    /// Gershgorin's, the largest over all particles of the inverse mass times the sum of the stiffnesses that
    /// act on the particle, that of a bar being max(1 / (C l), |T| / d).
    double add_forces(Components<const double> at_m, Components<double> force_n) const;
    /// The same for the bends alone.
    double add_bend_forces(Components<const double> at_m, Components<double> force_n) const;

    /// The same bound for usual states: bars no shorter than half of their rest lengths, joints bent by up to
    /// 0.2 radians.
    [[nodiscard]] double common_square_frequency() const;

    /// The energy of the bars and bends that are there at `time_s`.
    [[nodiscard]] double energy_j(const double* x_m, const double* y_m, double time_s = 0.0) const;

    /// Writes the tensions of the bars that stretch, in N, to an array of all bars of the system.
    void tensions(const double* x_m, const double* y_m, std::vector<double>& tension_n) const;

  private:
    struct Joint {
        std::uint32_t a = 0;
        std::uint32_t b = 0;
        std::uint32_t c = 0;
        double stiffness_n_m = 0.0;
        double before_m = 0.0;  ///< |ab| at the start
        double after_m = 0.0;   ///< |bc| at the start
    };
    void add_springs(const System& system, const Body& body);
    void add_joints(const System& system, std::size_t particle_count);
    void bound_frequencies(const double* inverse_mass_1_kg, std::size_t particle_count);

    std::size_t first_particle_ = 0;
    Springs springs_;
    std::vector<Joint> joints_;
    std::vector<double> spring_cut_s_;  ///< when each is gone; empty if none ever is
    std::vector<double> joint_cut_s_;
    /// Gershgorin's bounds for bars of at least half of their rest lengths, and for straight joints of the
    /// initial lengths.
    double spring_square_frequency_ = 0.0;
    double joint_square_frequency_ = 0.0;
};

/// Computes the energy of states; that of the weight is 0 at the origin of the system. A pin that will be let
/// go counts as a free particle from the start, so that its release changes no energy.
class EnergyMeter {
  public:
    /// `methods`: one per body of the system, or one for all. The system must outlive it.
    EnergyMeter(const System& system, const Forces& forces, std::span<const MethodDef> methods);

    /// The energy of a state that has velocities.
    [[nodiscard]] Energy of(const State& state) const;

  private:
    const System* system_;
    std::vector<Vec2> weight_n_;  ///< on each particle
    ElasticForces elastic_;
};

}  // namespace corda::sim
