// MuJoCo: a chain of hinges in reduced coordinates; a net of sliders with springs along tendons; a string as
// the limit of a tendon. Bodies have the least inertia that MuJoCo takes as a point.

#include <mujoco/mujoco.h>

#include <cmath>
#include <sstream>

#include "benchmark/peers/peer.hpp"

namespace corda::peers {
namespace {

constexpr const char* kPointInertia = "1e-14 1e-14 1e-14";

const Problem* bending_problem = nullptr;  // of mjcb_passive, which has no argument for it

void add_bending(const mjModel* model, mjData* data) {
    for (int i = 1; i < model->nv; ++i)
        data->qfrc_passive[i] -= bending_problem->bend_n_m * std::sin(data->qpos[i]);
}

std::string chain_bodies(const Problem& problem) {
    std::ostringstream xml;
    xml.precision(17);
    const std::size_t links = problem.count() - 1;
    const double link_m = problem.link_m();
    const double angle = problem.start_angle();
    for (std::size_t i = 0; i < links; ++i) {
        if (i == 0) {
            xml << "<body euler='0 0 " << angle << "'>";
        } else {
            xml << "<body pos='" << link_m << " 0 0'>";
        }
        xml << "<joint type='hinge' axis='0 0 1'/><inertial pos='" << link_m << " 0 0' mass='"
            << problem.system.mass_kg[i + 1] << "' diaginertia='" << kPointInertia << "'/><site name='s"
            << i + 1 << "' pos='" << link_m << " 0 0'/>";
    }
    for (std::size_t i = 0; i < links; ++i) xml << "</body>";
    return xml.str();
}

std::string point_bodies(const Problem& problem) {
    std::ostringstream xml;
    xml.precision(17);
    const System& system = problem.system;
    for (std::size_t i = 0; i < problem.count(); ++i) {
        xml << "<body pos='" << system.x_m[i] << " " << system.y_m[i] << " 0'>";
        if (!system.is_pinned(i)) {
            xml << "<joint type='slide' axis='1 0 0'/><joint type='slide' axis='0 1 0'/><inertial pos='0 0 "
                   "0' mass='"
                << system.mass_kg[i] << "' diaginertia='" << kPointInertia << "'/>";
        }
        xml << "<site name='s" << i << "'/></body>";
    }
    return xml.str();
}

std::string tendons(const Problem& problem) {
    std::ostringstream xml;
    xml.precision(17);
    for (const Bar& bar : problem.system.bars) {
        xml << "<spatial ";
        if (problem.is_string) {
            // The stiffest limit that is stable: a time constant of two steps.
            xml << "limited='true' range='0 " << bar.rest_m << "' solimplimit='0.9999 0.9999 1e-6'";
        } else {
            xml << "stiffness='" << problem.stiffness_n_m << "' springlength='" << bar.rest_m << "'";
        }
        xml << "><site site='s" << bar.a << "'/><site site='s" << bar.b << "'/></spatial>";
    }
    return xml.str();
}

class MujocoRun : public SteppedRun {
  public:
    MujocoRun(const Problem& problem, const char* integrator, double steps)
        : SteppedRun(problem, steps), problem_(problem) {
        std::ostringstream xml;
        xml.precision(17);
        xml << "<mujoco><compiler angle='radian' boundmass='0' boundinertia='0'/><size njmax='500' "
               "nconmax='10'/>"
            << "<option timestep='" << step_s_ << "' gravity='0 " << -problem.gravity() << " 0' integrator='"
            << integrator << "' jacobian='" << (is_net(problem) ? "sparse" : "dense")
            << "'><flag contact='disable'/></option><worldbody>"
            << (problem.is_chain() ? chain_bodies(problem) : point_bodies(problem)) << "</worldbody>";
        if (!problem.is_chain()) xml << "<tendon>" << tendons(problem) << "</tendon>";
        xml << "</mujoco>";
        const std::string text = xml.str();
        mjVFS* const files = new mjVFS;
        mj_defaultVFS(files);
        mj_makeEmptyFileVFS(files, "model.xml", static_cast<int>(text.size()));
        std::copy(text.begin(), text.end(), static_cast<char*>(files->filedata[files->nfile - 1]));
        char error[500] = "";
        model_ = mj_loadXML("model.xml", files, error, sizeof error);
        mj_deleteVFS(files);
        delete files;
        if (model_ == nullptr) throw Failure(error);
        if (problem.is_string) {
            model_->tendon_solref_lim[0] = 2.0 * step_s_;
            model_->tendon_solref_lim[1] = 1.0;
        }
        data_ = mj_makeData(model_);
        bending_problem = &problem;
        mjcb_passive = problem.bend_n_m > 0.0 ? add_bending : nullptr;
        mj_forward(model_, data_);
    }
    ~MujocoRun() override {
        if (data_ != nullptr) mj_deleteData(data_);
        if (model_ != nullptr) mj_deleteModel(model_);
    }
    void step() override { mj_step(model_, data_); }
    void read_step(State& state) override {
        if (data_->warning[mjWARN_BADQACC].number + data_->warning[mjWARN_BADQPOS].number +
                data_->warning[mjWARN_BADQVEL].number >
            0)
            throw Failure("diverged");
        if (problem_.is_chain()) {
            read_chain(state);
            return;
        }
        std::size_t dof = 0;
        for (std::size_t i = 0; i < problem_.count(); ++i) {
            if (problem_.system.is_pinned(i)) continue;
            state.x_m[i] = problem_.system.x_m[i] + data_->qpos[dof];
            state.y_m[i] = problem_.system.y_m[i] + data_->qpos[dof + 1];
            state.vx_m_s[i] = data_->qvel[dof];
            state.vy_m_s[i] = data_->qvel[dof + 1];
            dof += 2;
        }
    }

  private:
    void read_chain(State& state) const {
        const double link_m = problem_.link_m();
        double angle = problem_.start_angle();
        double omega = 0.0;
        for (std::size_t i = 0; i + 1 < problem_.count(); ++i) {
            angle += data_->qpos[i];
            omega += data_->qvel[i];
            const double c = link_m * std::cos(angle);
            const double s = link_m * std::sin(angle);
            state.x_m[i + 1] = state.x_m[i] + c;
            state.y_m[i + 1] = state.y_m[i] + s;
            state.vx_m_s[i + 1] = state.vx_m_s[i] - omega * s;
            state.vy_m_s[i + 1] = state.vy_m_s[i] + omega * c;
        }
    }

    const Problem& problem_;
    mjModel* model_ = nullptr;
    mjData* data_ = nullptr;
};

Series series(const char* integrator, bool (*can_run)(const Problem&)) {
    return {integrator, kStepsPerFrame, step_counts(),
            [integrator](const Problem& problem, double steps) {
                return std::make_unique<MujocoRun>(problem, integrator, steps);
            },
            can_run};
}

/// Without velocities in the forces, the implicit method gives the same as Euler's, and its stack overflows.
bool is_no_net(const Problem& problem) {
    return !is_net(problem);
}

void ignore(const char* /*message*/) {}

}  // namespace
}  // namespace corda::peers

int main(int argc, char** argv) {
    using namespace corda::peers;
    mju_user_warning = ignore;
    return run_peer(argc, argv, "MuJoCo", mj_versionString(),
                    {series("Euler", is_any), series("implicit", is_no_net), series("RK4", is_any)});
}
