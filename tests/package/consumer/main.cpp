// Renders a scene with the installed library: a still, a video, and the comparison of the still with another.
// Usage: consumer SCENE.toml STILL.png OUT.mp4; exits with 0 if still and film agree.

#define Status int  // as <X11/Xlib.h> does
#include <corda/corda.hpp>
#undef Status
#include <cstdio>

int main(int argc, char** argv) try {
    if (argc != 4) return 2;
    corda::Scene scene = corda::load_scene(argv[1]);
    scene.video.width_px = 320;
    scene.video.height_px = 180;
    scene.world.duration_s = 0.5;
    corda::Film film(scene);
    const corda::Difference difference = corda::compare(film.frame(10), corda::read_png(argv[2]));
    const corda::CancelScope uncancelled([] { return true; });
    std::int64_t last = 0;
    corda::render_video(film, argv[3], {.force = true, .on_progress = [&](std::int64_t k, std::int64_t) {
                                            last = k;
                                            return true;
                                        }});
    std::printf("max %d, share %g, %lld frames\n", difference.max, difference.share,
                static_cast<long long>(last));
    return difference.equal && last == film.frame_count() ? 0 : 7;
} catch (const corda::Error& error) {
    std::fprintf(stderr, "consumer: %s\n", error.what());
    return static_cast<int>(error.code());
}
