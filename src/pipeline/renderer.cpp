#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "corda/core/basics.hpp"
#include "corda/pipeline/describe.hpp"
#include "corda/pipeline/film.hpp"
#include "corda/pipeline/scene_renderer.hpp"
#include "corda/sim/system.hpp"

namespace corda {

struct Renderer::Impl {
    Impl(const Scene& given, const std::string& backend)
        : scene((check_definitions(given), given)),
          system(system_of(scene)),
          renderer(scene, system, backend, false) {
        if (quantity_of(scene.style.color_by)) {
            throw Error(ExitCode::kInvalidScene,
                        "style: color_by is a quantity of a motion, and a Renderer draws positions alone; "
                        "choose kBody or kLink");
        }
        if (scene.overlay.plot != LivePlot::kNone) {
            throw Error(
                ExitCode::kInvalidScene,
                "overlay: plot shows a whole motion, and a Renderer draws positions alone; leave it out");
        }
        camera = renderer.fit(bounds_of_start(system));
    }
    Scene scene;
    System system;
    pipeline::SceneRenderer renderer;
    CameraDef camera;
    State state;
};

Renderer::Renderer(const Scene& scene, const std::string& backend) {
    try {
        impl_ = std::make_unique<Impl>(scene, backend);
    } catch (const Refusal& refusal) {
        throw pipeline::explained(refusal, scene.source);
    }
}
Renderer::Renderer(Renderer&&) noexcept = default;
Renderer& Renderer::operator=(Renderer&&) noexcept = default;
Renderer::~Renderer() = default;

const CameraDef& Renderer::camera() const {
    return impl_->camera;
}

Image Renderer::draw(std::span<const Vec2> positions_m) {
    const std::size_t count = impl_->system.particle_count();
    if (positions_m.size() != count) {
        throw Error(ExitCode::kUsage,
                    fmt::format("{} positions for the {} particles of the scene; give one each",
                                positions_m.size(), count));
    }
    State& state = impl_->state;
    state.x_m.resize(count);
    state.y_m.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
        if (!std::isfinite(positions_m[i].x) || !std::isfinite(positions_m[i].y))
            throw Error(ExitCode::kUsage, fmt::format("position {} is not finite", i));
        state.x_m[i] = positions_m[i].x - impl_->system.origin_m.x;
        state.y_m[i] = positions_m[i].y - impl_->system.origin_m.y;
    }
    const pipeline::SceneRenderer::Use use(impl_->renderer);
    impl_->renderer.draw(state, impl_->renderer.map_of(impl_->camera));
    return impl_->renderer.image();
}

}  // namespace corda
