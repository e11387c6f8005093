// Your own motion drawn as a film: a standing wave on a ring, from a formula.
// Usage: example_own_particles OUT.mp4

#include <cmath>
#include <corda/corda.hpp>
#include <cstdio>
#include <numbers>

int main(int argc, char** argv) try {
    if (argc != 2) return std::fputs("usage: example_own_particles OUT.mp4\n", stderr), 2;
    constexpr int kCount = 72;
    std::vector<double> times_s;
    std::vector<corda::Vec2> positions_m;  // all particles at the first time, then at the next
    for (int k = 0; k <= 120; ++k) {
        times_s.push_back(k / 60.0);
        const double amplitude_m = 0.25 * std::cos(2.0 * std::numbers::pi * times_s.back());
        for (int i = 0; i < kCount; ++i) {
            const double angle = 2.0 * std::numbers::pi * i / kCount;
            const double radius_m = 1.0 + amplitude_m * std::cos(6.0 * angle);
            positions_m.push_back({radius_m * std::cos(angle), radius_m * std::sin(angle)});
        }
    }
    corda::RopeDef ring;
    ring.points_m.assign(positions_m.begin(), positions_m.begin() + kCount);
    ring.closed = true;
    ring.pinned.clear();
    corda::Scene scene;
    scene.name = "ring";
    scene.ropes = {ring};
    scene.style.markers = corda::Markers::kAll;
    scene.video.width_px = 480;
    scene.video.height_px = 480;

    corda::Film film(scene, corda::GivenMotion(times_s, positions_m));  // as long as the times
    corda::render_video(film, argv[1], {.force = true});
} catch (const corda::Error& error) {
    std::fprintf(stderr, "example_own_particles: %s\n", error.what());
    return static_cast<int>(error.code());
}
