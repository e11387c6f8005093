// Your own particles drawn by Corda's renderer: a standing wave on a ring, from a formula.
// Usage: example_own_particles OUT.png

#include <cmath>
#include <corda/corda.hpp>
#include <cstdio>
#include <numbers>

int main(int argc, char** argv) try {
    if (argc != 2) return std::fputs("usage: example_own_particles OUT.png\n", stderr), 2;
    constexpr int kCount = 72;
    const auto wave = [](double amplitude_m) {
        std::vector<corda::Vec2> points_m;
        for (int i = 0; i < kCount; ++i) {
            const double angle = 2.0 * std::numbers::pi * i / kCount;
            const double radius_m = 1.0 + amplitude_m * std::cos(6.0 * angle);
            points_m.push_back({radius_m * std::cos(angle), radius_m * std::sin(angle)});
        }
        return points_m;
    };
    corda::RopeDef ring;
    ring.points_m = wave(0.25);
    ring.closed = true;
    corda::Scene scene;
    scene.ropes = {ring};
    scene.style.markers = corda::Markers::kAll;
    scene.video.width_px = 480;
    scene.video.height_px = 480;

    corda::Renderer renderer(scene);  // a camera that fits the widest wave
    corda::write_png(argv[1], renderer.draw(wave(0.15)), {}, {.force = true});
} catch (const corda::Error& error) {
    std::fprintf(stderr, "example_own_particles: %s\n", error.what());
    return static_cast<int>(error.code());
}
