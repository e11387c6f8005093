// A scene built in code: a rope of ten links with a heavy bob, simulated without drawing, then drawn.
// Usage: example_built_scene OUT.png

#include <corda/corda.hpp>
#include <cstdio>

int main(int argc, char** argv) try {
    if (argc != 2) return std::fputs("usage: example_built_scene OUT.png\n", stderr), 2;
    corda::RopeDef rope;
    for (int i = 0; i <= 10; ++i) rope.points_m.push_back({0.06 * i, -0.08 * i});
    rope.mass_kg.assign(rope.points_m.size(), 0.1);
    rope.payload_kg = 2.0;

    corda::Scene scene;
    scene.name = "built";
    scene.ropes = {rope};
    scene.world.duration_s = 2.0;
    scene.video.width_px = 640;
    scene.video.height_px = 360;

    corda::Simulation simulation(corda::system_of(scene), scene.world, corda::ExactDef{});
    for (int k = 0; k <= 4; ++k) {
        if (simulation.advance_to(0.5 * k) == corda::Status::kDiverged) return 8;
        const corda::State& state = simulation.state();
        std::printf("t = %.1f s: tip at (%+.4f, %+.4f) m\n", state.time_s, state.x_m.back(),
                    state.y_m.back());
    }
    corda::write_png(argv[1], corda::Film(scene).still(1.5), {}, {.force = true});
} catch (const corda::Error& error) {
    std::fprintf(stderr, "example_built_scene: %s\n", error.what());
    return static_cast<int>(error.code());
}
