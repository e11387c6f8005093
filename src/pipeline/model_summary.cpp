#include "corda/pipeline/model_summary.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "corda/pipeline/describe.hpp"
#include "corda/sim/forces/forces.hpp"
#include "corda/view/number_text.hpp"

namespace corda {
namespace {

/// The values above 0 of one figure of all bodies.
class Values {
  public:
    void include(double value) {
        if (value == 0.0) return;
        low_ = std::min(low_, value);
        high_ = std::max(high_, value);
    }
    [[nodiscard]] bool empty() const { return high_ == 0.0; }
    [[nodiscard]] std::string text() const {
        return low_ == high_ ? fmt::format("{}", low_) : fmt::format("{} .. {}", low_, high_);
    }

  private:
    double low_ = HUGE_VAL;
    double high_ = 0.0;
};

/// What the bodies are made of.
struct Materials {
    Values compliance_1_n;
    Values bending_n_m2;
    bool rigid = false;
    bool slack = false;    ///< a string, of either kind
    bool plastic = false;  ///< a rigid string: energy is lost when it comes taut
};

Materials list_materials(const Scene& scene) {
    Materials result;
    const auto include = [&result](const MaterialDef& material) {
        const bool rigid = material.compliance_1_n == 0.0;
        result.compliance_1_n.include(material.compliance_1_n);
        result.rigid = result.rigid || rigid;
        result.slack = result.slack || material.is_string;
        result.plastic = result.plastic || (material.is_string && rigid);
    };
    for (const RopeDef& rope : scene.ropes) {
        include(rope.material);
        result.bending_n_m2.include(rope.bending_n_m2);
    }
    for (const NetDef& net : scene.nets) include(net.material);
    return result;
}

/// The forces, and where energy is lost if not by drag.
std::vector<std::string> force_terms(const Scene& scene, const Materials& materials,
                                     const RelaxationDef* relaxation) {
    std::vector<std::string> terms;
    const bool is_replaced = relaxation != nullptr && relaxation->force_n;
    if (is_replaced) {
        terms.push_back(fmt::format("a force of ({}, {}) N per particle, in place of gravity",
                                    relaxation->force_n->x, relaxation->force_n->y));
    }
    for (const sim::ForceKind& kind : sim::force_kinds()) {
        const bool has_drag = kind.term(scene.world).drag_1_s != 0.0;
        const std::string text = is_replaced && !has_drag ? "" : kind.text(scene.world);
        if (!text.empty()) terms.push_back(text);
    }
    if (sim::Forces(scene.world).drag_1_s() != 0.0) return terms;
    if (relaxation != nullptr && relaxation->delta > 0.0)
        terms.push_back(
            fmt::format("damping: a share of {} of the velocity is lost per step", relaxation->delta));
    else if (relaxation != nullptr)
        terms.emplace_back("no drag; the passes lose energy, and print how much");
    else if (materials.plastic)
        terms.emplace_back("no drag: energy is lost only when a string comes taut");
    else
        terms.emplace_back("no drag: energy is kept");
    return terms;
}

std::string nets_term(const Scene& scene) {
    std::size_t real = 0;
    std::size_t all = 0;
    for (const NetDef& net : scene.nets) {
        all += net.bars.size();
        real += static_cast<std::size_t>(
            std::count_if(net.bars.begin(), net.bars.end(), [](const NetBar& bar) { return bar.is_real; }));
    }
    return fmt::format("nets: {}, of {} bars and {} imaginary ones", scene.nets.size(), real, all - real);
}

}  // namespace

std::vector<std::string> modelled_terms(const Scene& scene, const Plan& plan) {
    const RelaxationDef* relaxation = nullptr;
    bool relaxes_all = true;
    for (const BodyPlan& body : plan.bodies) {
        const auto* const def = std::get_if<RelaxationDef>(&body.method);
        relaxes_all = relaxes_all && def != nullptr;
        if (def != nullptr) relaxation = def;
    }
    const Materials materials = list_materials(scene);
    std::vector<std::string> terms = force_terms(scene, materials, relaxation);
    if (relaxation != nullptr) terms.emplace_back("bars that stretch by what the passes of relaxation leave");
    if (!relaxes_all && materials.rigid) terms.emplace_back("links that do not stretch");
    if (!materials.compliance_1_n.empty()) {
        terms.push_back(fmt::format("links that stretch by {} of their length per newton",
                                    materials.compliance_1_n.text()));
    }
    if (materials.slack) terms.emplace_back("strings: links that pull and never push");
    if (!materials.bending_n_m2.empty())
        terms.push_back(fmt::format("bending stiffness of {} N m2", materials.bending_n_m2.text()));
    const auto closed = std::count_if(scene.ropes.begin(), scene.ropes.end(),
                                      [](const RopeDef& rope) { return rope.closed; });
    if (closed > 0) terms.push_back(fmt::format("closed ropes: {}", closed));
    if (!scene.nets.empty()) terms.push_back(nets_term(scene));
    return terms;
}

std::optional<std::string> bound_text(Film& film) {
    const Plan& plan = film.plan();
    std::optional<double> largest_m;
    std::vector<std::size_t> unbounded;
    for (std::size_t i = 0; i < plan.bodies.size(); ++i) {
        if (plan.bodies[i].error_bound_m)
            largest_m = std::max(largest_m.value_or(0.0), *plan.bodies[i].error_bound_m);
        else
            unbounded.push_back(i);
    }
    if (!largest_m || plan.horizon_s == 0.0) return std::nullopt;
    const double pixels_per_metre = film.scene().video.height_px / film.camera().height_m.value();
    std::string text = fmt::format("{:.2g} px, {:.2g} m", view::rounded_up(pixels_per_metre * *largest_m),
                                   view::rounded_up(*largest_m));
    if (plan.horizon_s) text += fmt::format(", up to {:.6g} s", *plan.horizon_s);
    if (!unbounded.empty()) text += ", but for " + describe(film.system(), unbounded);
    return text;
}

}  // namespace corda
