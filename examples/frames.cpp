// Frames in a loop, for your own encoder or viewer. This program computes the share of the picture that the
// rope covers. Usage: example_frames SCENE.toml

#include <algorithm>
#include <corda/corda.hpp>
#include <cstdio>

int main(int argc, char** argv) try {
    if (argc != 2) return std::fputs("usage: example_frames SCENE.toml\n", stderr), 2;
    corda::Scene scene = corda::load_scene(argv[1]);
    scene.video.width_px = 320;
    scene.video.height_px = 180;
    scene.style.theme = corda::Theme::kPaper;
    scene.style.background.reset();
    corda::Film film(scene);
    corda::Image background(320, 180);
    std::fill_n(background.data(), background.size_bytes(), 255);  // white
    for (std::int64_t k = 0; k < film.frame_count(); k += 60) {
        const corda::Difference covered = corda::compare(film.frame(k), background);
        std::printf("t = %4.1f s: %.2f %% of the picture\n", film.time_s(k), 100.0 * covered.share);
    }
} catch (const corda::Error& error) {
    std::fprintf(stderr, "example_frames: %s\n", error.what());
    return static_cast<int>(error.code());
}
