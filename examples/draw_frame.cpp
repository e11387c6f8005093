// Drawing alone: a list of capsules becomes a PNG through OpenGL, and the same picture without it.
// Usage: draw_frame OUT.png

#include <cstdio>
#include <exception>

#include "corda/gl/context.hpp"
#include "corda/media/png.hpp"
#include "corda/render/frame_renderer.hpp"
#include "corda/render/reference_renderer.hpp"
#include "corda/view/capsule.hpp"

namespace {

void draw(const char* path) {
    constexpr int kWidth = 320;
    constexpr int kHeight = 180;
    corda::view::DrawList list;
    list.width = kWidth;
    list.height = kHeight;
    list.background = {0x12, 0x16, 0x1f, 255};
    for (int i = 0; i < 8; ++i) {
        const auto line = corda::view::make_capsule({40.0 + 30.0 * i, 20.0}, {40.0 + 24.0 * i, 160.0},
                                                    1.0 + i, kWidth, kHeight);
        if (!line) continue;
        list.bounds = list.bounds.united(corda::view::capsule_bounds(*line, kWidth, kHeight));
        list.capsules.push_back(*line);
    }
    list.layers.push_back({{0xe8, 0xc0, 0x7d, 255}, 0, list.capsules.size()});

    const corda::gl::Context context;
    corda::render::FrameRenderer renderer(kWidth, kHeight);
    renderer.render(list);
    corda::media::write_png(path, renderer.image());
    const bool same = renderer.image() == corda::render::render_reference(list);
    std::printf("%s by %s; the reference renderer draws %s bytes\n", path, context.info().gl_renderer.c_str(),
                same ? "the same" : "other");
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 2) {
        std::fprintf(stderr, "usage: draw_frame OUT.png\n");
        return 2;
    }
    try {
        draw(argv[1]);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "draw_frame: %s\n", error.what());
        return 1;
    }
    return 0;
}
