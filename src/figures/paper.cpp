#include "corda/figures/paper.hpp"

#include <algorithm>
#include <cmath>

#include "corda/view/colors.hpp"

namespace corda::figures {
namespace {

/// Relative luminance of a colour over white, as WCAG 2.1 defines it, without its gamma of sRGB's foot.
double luminance(const Color& color) {
    const auto linear = [&](int channel) {
        constexpr double kGamma = 2.2;
        const double over_white = (channel * color.a + 255.0 * (255 - color.a)) / (255.0 * 255.0);
        return std::pow(over_white, kGamma);
    };
    return 0.2126 * linear(color.r) + 0.7152 * linear(color.g) + 0.0722 * linear(color.b);
}

bool all_show(const std::vector<Color>& colors) {
    return std::all_of(colors.begin(), colors.end(), shows_on_white);
}

}  // namespace

bool shows_on_white(Color color) {
    constexpr double kContrast = 2.0;
    constexpr double kGlare = 0.05;
    return (1.0 + kGlare) / (luminance(color) + kGlare) >= kContrast;
}

void prefer_paper(Scene& scene) {
    StyleDef& style = scene.style;
    const auto& ground = style.background;
    const bool is_dark = ground && (shows_on_white(ground->top) || shows_on_white(ground->bottom));
    const bool show = all_show(style.palette) &&
                      std::all_of(scene.body_styles.begin(), scene.body_styles.end(), [](const auto& body) {
                          return (!body.color || shows_on_white(*body.color)) && all_show(body.link_colors);
                      });
    if (!style.theme && !is_dark && show) style.theme = Theme::kPaper;
}

std::vector<std::string> curve_colors(const Scene& scene, const std::vector<std::size_t>& bodies) {
    const std::vector<Color> palette = view::look_of(scene.style).palette;
    std::vector<std::string> texts;
    std::size_t next = 0;
    for (std::size_t b = 0; !bodies.empty() && b <= bodies.back(); ++b) {
        const BodyStyleDef own = b < scene.body_styles.size() ? scene.body_styles[b] : BodyStyleDef{};
        Color color = own.color ? *own.color : palette[next++ % palette.size()];
        if (std::find(bodies.begin(), bodies.end(), b) == bodies.end()) continue;
        color.a = 255;
        const std::string text = color.text();
        const bool is_taken = std::find(texts.begin(), texts.end(), text) != texts.end();
        const bool tells_bodies = scene.style.color_by == ColorBy::kBody;
        if (is_taken || !tells_bodies || !shows_on_white(color))
            return std::vector<std::string>(bodies.size());
        texts.push_back(text);
    }
    return texts;
}

}  // namespace corda::figures
