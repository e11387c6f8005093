#include "corda/serve/smaller.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <cstdlib>
#include <string>

#include "corda/film/film.hpp"
#include "corda/scene/schema.hpp"

namespace corda::serve {
namespace {

Image filled(int width, int height, const Color& color) {
    Image image(width, height);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            image.pixel(x, y)[0] = color.r;
            image.pixel(x, y)[1] = color.g;
            image.pixel(x, y)[2] = color.b;
            image.pixel(x, y)[3] = color.a;
        }
    return image;
}

TEST(MadeSmaller, IsTheMeanOfWhatAPixelCovers) {
    const Color color{200, 100, 3, 77};
    EXPECT_EQ(made_smaller(filled(100, 7, color), 33, 7), filled(33, 7, color));
    Image image(3, 1);
    for (int x = 0; x < 3; ++x) {
        image.pixel(x, 0)[0] = static_cast<std::uint8_t>(100 * x);
        image.pixel(x, 0)[3] = 255;
    }
    const Image two = made_smaller(image, 2, 1);
    EXPECT_EQ(two.pixel(0, 0)[0], 33);   // (0 + 100 / 2) / 1.5
    EXPECT_EQ(two.pixel(1, 0)[0], 167);  // (100 / 2 + 200) / 1.5
    image.pixel(2, 0)[3] = 0;            // the colour of what is not seen does not count
    EXPECT_EQ(made_smaller(image, 2, 1).pixel(1, 0)[0], 100);
    EXPECT_EQ(made_smaller(image, 2, 1).pixel(1, 0)[3], 85);
}

/// Mean difference of all channels.
double difference(const Image& a, const Image& b) {
    double sum = 0.0;
    for (std::size_t i = 0; i < a.size_bytes(); ++i) sum += std::abs(a.data()[i] - b.data()[i]);
    return sum / static_cast<double>(a.size_bytes());
}

/// A picture of a scene that is drawn at another size is the picture made smaller, whatever the scene says in
/// pixels.
TEST(ScaledTo, ShowsTheSceneMadeSmaller) {
    constexpr const char* kScene = R"(schema = 1
overlay = { time = false, scale_bar = false }
world.duration = 0.5
[style]
markers = "all"
bars = "all"
supports = false
rope_width_px = 6
net_width_px = 5
bar_width_px = 4
marker_radius_px = 7
[[rope]]
hang = { links = 3, length = 1.0, angle_deg = 70.0 }
[[net]]
grid = { columns = 4, rows = 4, from = [0.2, 0.0], spacing = 0.25, diagonals = true }
pinned = [0, 3]
[video]
size = [1280, 720]
fps = 10
)";
    int count = 0;
    for (const scene::Key& key : scene::all_keys()) {
        if (key.unit != "px" || key.section == "video" || key.section == "golden") continue;
        const bool is_of_text = key.section == "overlay.texts";
        const bool is_text = key.name == "text_px" || is_of_text;
        std::string path(key.section);
        if (path == "rope" || path == "net" || is_of_text) path += "[0]";
        std::vector<Setting> settings;
        if (is_of_text) settings.emplace_back("overlay.texts=[{text='A text'}]");
        const bool is_of_arrows = key.name == "arrow_scale";
        if (is_of_arrows)
            settings.insert(settings.end(), {"style.arrows='velocity'", "overlay.legend=false"});
        settings.push_back(fmt::format("{}.{}=24", path, key.name));
        if (key.name == "text_px")
            settings.insert(settings.end(), {"overlay.time=true", "overlay.title='A title'"});
        const Scene whole = parse_scene(kScene, "scene.toml", settings);
        const Image frame = Film(whole).frame(4);
        for (const auto& [width, height] :
             {std::pair(960, 540), std::pair(640, 360), std::pair(480, 270), std::pair(320, 180)}) {
            const Image preview = Film(scaled_to(whole, width, height)).frame(4);
            // Measured: 0.35 at most; 3.8 for text, whose letters have whole pixels, and 13 if it stays; 3.8
            // for arrows, whose shafts have a least width.
            EXPECT_LT(difference(preview, made_smaller(frame, width, height)),
                      is_text || is_of_arrows ? 5.0 : 0.5)
                << scene::path_of(key) << " at " << width;
        }
        ++count;
    }
    EXPECT_GE(count, 8);
}

}  // namespace
}  // namespace corda::serve
