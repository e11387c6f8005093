// Simbody: a chain of pins in reduced coordinates; a net of points that slide, with its springs. Integrated
// by its explicit Runge-Kutta methods and by CPODES under error control.

#include <Simbody.h>

#include <cmath>

#include "benchmark/peers/simbody_model.hpp"

namespace corda::peers {
namespace {

using namespace SimTK;

/// The torques of the bends, whose angles are the coordinates of the pins.
class Bending : public Force::Custom::Implementation {
  public:
    Bending(const SimbodyMatterSubsystem& matter, double stiffness_n_m)
        : matter_(matter), stiffness_n_m_(stiffness_n_m) {}
    void calcForce(const SimTK::State& state, Vector_<SpatialVec>& /*bodies*/, Vector_<Vec3>& /*particles*/,
                   Vector& torques) const override {
        for (MobilizedBodyIndex i(2); i < matter_.getNumBodies(); ++i) {
            const auto& pin = MobilizedBody::Pin::downcast(matter_.getMobilizedBody(i));
            pin.applyOneMobilityForce(state, 0, -stiffness_n_m_ * std::sin(pin.getAngle(state)), torques);
        }
    }
    Real calcPotentialEnergy(const SimTK::State& /*state*/) const override { return 0.0; }

  private:
    const SimbodyMatterSubsystem& matter_;
    double stiffness_n_m_;
};

class Model : public SimbodyModel {
  public:
    Model(const SimbodyDef& def, SimbodyMethod method, double accuracy)
        : def_(def), matter_(system_), forces_(system_) {
        Force::UniformGravity(forces_, matter_, Vec3(0, -def.gravity, 0));
        if (is_chain()) {
            add_chain();
        } else {
            add_net();
        }
        system_.realizeTopology();
        SimTK::State state = system_.getDefaultState();
        switch (method) {
            case SimbodyMethod::kMerson:
                integrator_ = std::make_unique<RungeKuttaMersonIntegrator>(system_);
                break;
            case SimbodyMethod::kFehlberg:
                integrator_ = std::make_unique<RungeKuttaFeldbergIntegrator>(system_);
                break;
            case SimbodyMethod::kVerlet:
                integrator_ = std::make_unique<VerletIntegrator>(system_);
                break;
            case SimbodyMethod::kCpodesAdams:
                integrator_ = std::make_unique<CPodesIntegrator>(system_, CPodes::Adams, CPodes::Functional);
                break;
        }
        integrator_->setAccuracy(accuracy);
        stepper_ = std::make_unique<TimeStepper>(system_, *integrator_);
        stepper_->initialize(state);
    }
    void step_to(double time_s) override { stepper_->stepTo(time_s); }
    void read(std::vector<double>& x, std::vector<double>& y, std::vector<double>& vx,
              std::vector<double>& vy) override {
        const SimTK::State& now = stepper_->getState();
        system_.realize(now, Stage::Velocity);
        for (std::size_t i = 0; i < def_.x.size(); ++i) {
            if (def_.is_pinned[i]) continue;
            const MobilizedBody& body = matter_.getMobilizedBody(body_of_[i]);
            const Vec3 at = is_chain() ? Vec3(def_.rest_m, 0, 0) : Vec3(0);
            const Vec3 place = body.findStationLocationInGround(now, at);
            const Vec3 velocity = body.findStationVelocityInGround(now, at);
            x[i] = place[0];
            y[i] = place[1];
            vx[i] = velocity[0];
            vy[i] = velocity[1];
        }
    }

  private:
    [[nodiscard]] bool is_chain() const { return def_.stiffness_n_m == 0.0; }
    void add_chain() {
        const double link_m = def_.rest_m;
        body_of_.assign(def_.x.size(), MobilizedBodyIndex(0));
        for (std::size_t i = 1; i < def_.x.size(); ++i) {
            const Vec3 at(link_m, 0, 0);
            const double mass = def_.mass[i];
            const Body::Rigid point(MassProperties(mass, at, mass * UnitInertia::pointMassAt(at)));
            MobilizedBody& parent = matter_.updMobilizedBody(body_of_[i - 1]);
            MobilizedBody::Pin pin(parent, Transform(i == 1 ? Vec3(0) : at), point, Transform(Vec3(0)));
            if (i == 1) pin.setDefaultAngle(def_.start_angle);
            body_of_[i] = pin.getMobilizedBodyIndex();
        }
        if (def_.bend_n_m > 0.0) Force::Custom(forces_, new Bending(matter_, def_.bend_n_m));
    }
    void add_net() {
        body_of_.assign(def_.x.size(), MobilizedBodyIndex(0));
        for (std::size_t i = 0; i < def_.x.size(); ++i) {
            if (def_.is_pinned[i]) continue;
            const Body::Rigid point(MassProperties(def_.mass[i], Vec3(0), Inertia(0)));
            const Vec3 at(def_.x[i], def_.y[i], 0);
            MobilizedBody::Translation body(matter_.Ground(), Transform(at), point, Transform(Vec3(0)));
            body_of_[i] = body.getMobilizedBodyIndex();
        }
        for (const auto& [a, b] : def_.bars) {
            if (def_.is_pinned[a] && def_.is_pinned[b]) continue;
            Force::TwoPointLinearSpring(forces_, matter_.getMobilizedBody(body_of_[a]), station(a),
                                        matter_.getMobilizedBody(body_of_[b]), station(b), def_.stiffness_n_m,
                                        def_.rest_m);
        }
    }
    /// Of a particle in the frame of its body; pinned ones belong to the ground.
    [[nodiscard]] Vec3 station(std::size_t i) const {
        return def_.is_pinned[i] ? Vec3(def_.x[i], def_.y[i], 0) : Vec3(0);
    }

    SimbodyDef def_;
    MultibodySystem system_;
    SimbodyMatterSubsystem matter_;
    GeneralForceSubsystem forces_;
    std::vector<MobilizedBodyIndex> body_of_;
    std::unique_ptr<Integrator> integrator_;
    std::unique_ptr<TimeStepper> stepper_;
};

}  // namespace

std::unique_ptr<SimbodyModel> SimbodyModel::make(const SimbodyDef& def, SimbodyMethod method,
                                                 double accuracy) {
    return std::make_unique<Model>(def, method, accuracy);
}

std::string SimbodyModel::version() {
    int major = 0, minor = 0, build = 0;
    SimTK_version_simbody(&major, &minor, &build);
    return std::to_string(major) + "." + std::to_string(minor);
}

}  // namespace corda::peers
