#include <fmt/format.h>

#include <algorithm>

#include "corda/core/basics.hpp"
#include "corda/pipeline/film.hpp"

namespace corda {
namespace {

struct SolverLines {
    const System& system;

    std::string operator()(const ExactDef& def) const {
        return fmt::format("method = \"exact\"\ntolerance = {}\n", def.tolerance);
    }
    std::string operator()(const RattleDef& def) const {
        return fmt::format("method = \"rattle\"\norder = {}\nstep = {}\n", def.order, def.step_s.value());
    }
    std::string operator()(const RelaxationDef& def) const {
        std::string lines =
            fmt::format("method = \"relaxation\"\nstep = {}\nreach = {}\nsweeps = {}\ndelta = {}\n",
                        def.step_s.value(), reach(), def.sweeps, def.delta);
        if (def.force_n) lines += fmt::format("force = [{}, {}]\n", def.force_n->x, def.force_n->y);
        return lines;
    }

    /// The longest reach of a rope's bars: that of all ropes that are long enough for it. A file has but one.
    [[nodiscard]] std::uint32_t reach() const {
        std::uint32_t longest = 1;
        for (const Body& body : system.bodies) {
            for (std::size_t k = body.first_bar; !body.is_net && k < body.first_bar + body.bar_count; ++k)
                longest = std::max(longest, system.bars[k].reach);
        }
        for (const Body& body : system.bodies) {
            const bool closed = body.link_count == body.particle_count;
            if (!body.is_net && body.bar_count != bar_count(body.particle_count, longest, closed)) {
                throw Error(ExitCode::kUsage,
                            "the ropes differ in reach, which a scene file cannot say; give all of them one");
            }
        }
        return longest;
    }
};

}  // namespace

std::string frozen_toml(const Film& film) {
    const CameraDef& camera = film.camera();
    // Shortest texts that read back to the same bits.
    return fmt::format("[solver]\n{}\n[camera]\ncenter = [{}, {}]\nheight = {}\n",
                       std::visit(SolverLines{film.system()}, film.plan().method), camera.center_m->x,
                       camera.center_m->y, *camera.height_m);
}

}  // namespace corda
