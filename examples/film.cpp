// A film in ten lines: a scene file becomes a video and a still.
// Usage: example_film SCENE.toml OUT.mp4 OUT.png

#include <corda/corda.hpp>
#include <cstdio>

int main(int argc, char** argv) try {
    if (argc != 4) return std::fputs("usage: example_film SCENE.toml OUT.mp4 OUT.png\n", stderr), 2;
    corda::Film film(corda::load_scene(argv[1]));
    corda::write_png(argv[3], film.still(0.5), {}, {.force = true});
    corda::render_video(film, argv[2], {.force = true});
} catch (const corda::Error& error) {
    std::fprintf(stderr, "example_film: %s\n", error.what());
    return static_cast<int>(error.code());
}
