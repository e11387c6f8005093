#include <memory>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "corda/core/clock.hpp"
#include "corda/pipeline/describe.hpp"
#include "interrupt.hpp"

namespace corda::app {

OnProgress show_progress(const Console& console, const std::string& what) {
    constexpr double kSilentSeconds = 1.0;
    const double start_s = now_s();
    return [&console, what, start_s, progress = std::shared_ptr<Progress>()](std::int64_t done,
                                                                             std::int64_t total) mutable {
        stop_if_asked();
        if (done == 0 || !progress) progress = std::make_shared<Progress>(console, what, total);
        if (now_s() - start_s > kSilentSeconds) progress->update(done);
        return true;
    };
}

std::string bound_text(const Film& film) {
    const Plan& plan = film.plan();
    std::string text = fmt::format("{:.2g} px, {:.2g} m", *film.error_bound_px(), *plan.error_bound_m);
    if (plan.horizon_s) text += fmt::format(", up to {:.6g} s", *plan.horizon_s);
    return text;
}

void report_plan(const Console& console, const Film& film) {
    const Plan& plan = film.plan();
    const auto* automatic = std::get_if<AutoDef>(&film.scene().solver);
    if (automatic == nullptr) return;
    if (!plan.error_bound_m) {
        console.warning(fmt::format("auto: {}: {}", describe(plan.method), describe(plan)));
        return;
    }
    console.info(fmt::format("auto: {}; displayed error at most {}, shown by a tighter run",
                             describe(plan.method), bound_text(film)));
    if (!plan.horizon_s) return;
    if (plan.diverges) {
        console.warning(fmt::format(
            "the simulation diverges after {:.6g} s; less speed, force or drag may help", *plan.horizon_s));
    } else {
        console.warning(fmt::format(
            "predictability ends at {:.6g} s: from there two runs of the highest precision differ "
            "by more than {:g} px, because the motion magnifies the least differences; what is "
            "drawn after it is one possible motion",
            *plan.horizon_s, automatic->tolerance_px));
    }
}

nlohmann::json film_json(const Film& film) {
    const Plan& plan = film.plan();
    const System& system = film.system();
    nlohmann::json json = {{"schema", 1},
                           {"method", method_name(plan.method)},
                           {"solver", describe(plan.method)},
                           {"particles", system.particle_count()},
                           {"bars", system.bars.size()},
                           {"links", system.link_count()},
                           {"error_bound_m", nullptr},
                           {"error_bound_px", nullptr},
                           {"horizon_s", nullptr}};
    if (plan.error_bound_m) {
        json["error_bound_m"] = *plan.error_bound_m;
        json["error_bound_px"] = *film.error_bound_px();
    }
    if (plan.horizon_s) json["horizon_s"] = *plan.horizon_s;
    const CameraDef& camera = film.camera();
    json["camera"] = {{"center", {camera.center_m->x, camera.center_m->y}}, {"height", *camera.height_m}};
    json["simulation_passes"] = film.simulation_passes();
    return json;
}

}  // namespace corda::app
