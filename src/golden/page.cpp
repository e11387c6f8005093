#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>

#include "corda/core/file.hpp"
#include "corda/core/markup.hpp"
#include "corda/core/text.hpp"
#include "corda/golden/page_text.hpp"
#include "corda/golden/suite.hpp"
#include "corda/media/png/png.hpp"

namespace corda::golden {
namespace {

constexpr int kGain = 16;  // of the difference: one step of 255 is seen

std::string figure_html(const char* kind, const std::string& caption, const Image& image) {
    return fmt::format(
        "<figure class=\"{}\"><img alt=\"{}\" width=\"{}\" height=\"{}\" "
        "src=\"data:image/png;base64,{}\"><figcaption>{}</figcaption></figure>\n",
        kind, caption, image.width(), image.height(), base64(media::png_bytes(image, {})), caption);
}

/// The reference of a picture, if it can be read.
std::optional<Image> reference_of(const Checked& picture) {
    if (picture.reference.empty()) return std::nullopt;
    try {
        return read_png(picture.reference);
    } catch (const Error&) {
        return std::nullopt;
    }
}

std::string case_html(const Checked& picture) {
    std::string html = fmt::format("<section id=\"{0}\">\n<h2>{0}</h2>\n<p class=\"cause\">{1}</p>\n",
                                   markup_text(picture.name), markup_text(picture.why()));
    if (const std::string figures = picture.figures(); !figures.empty())
        html += fmt::format("<p class=\"figures\">{}</p>\n", figures);
    const bool is_shown = picture.drawn || picture.verdict == Verdict::kStale;
    const auto reference = is_shown ? reference_of(picture) : std::nullopt;
    if (!is_shown) html += "<p>Too many pictures failed to show all of them; check this scene alone.</p>\n";
    if (reference && picture.drawn) html += kPageModes;
    html += "<div class=\"pictures\">\n";
    if (reference) html += figure_html("reference", "reference", *reference);
    if (picture.drawn) html += figure_html("drawn", "new", *picture.drawn);
    if (reference && picture.drawn)
        html += figure_html("difference", "difference × 16", amplified(*reference, *picture.drawn));
    return html + "</div>\n</section>\n";
}

}  // namespace

Image amplified(const Image& a, const Image& b) {
    Image result(std::max(a.width(), b.width()), std::max(a.height(), b.height()));
    for (int y = 0; y < result.height(); ++y) {
        for (int x = 0; x < result.width(); ++x) {
            std::uint8_t* const to = result.pixel(x, y);
            to[3] = 255;
            const bool in_both = x < std::min(a.width(), b.width()) && y < std::min(a.height(), b.height());
            if (!in_both) {
                to[2] = 255;
                continue;
            }
            const std::uint8_t* const p = a.pixel(x, y);
            const std::uint8_t* const q = b.pixel(x, y);
            const int alpha = std::abs(p[3] - q[3]);
            for (int c = 0; c < 3; ++c)
                to[c] =
                    static_cast<std::uint8_t>(std::min(255, kGain * std::max(alpha, std::abs(p[c] - q[c]))));
        }
    }
    return result;
}

std::string page_html(const SuiteResult& result) {
    const std::int64_t failed = std::ranges::count_if(result.pictures, &Checked::failed);
    std::string html = fmt::format(kPageHead, kPageStyle, kPicturesStyle);
    html += fmt::format("<h1>Golden pictures: {} failed</h1>\n<p>{}. Drawn by corda {}.</p>\n", failed,
                        result.totals(), version());
    for (const Checked& picture : result.pictures)
        if (picture.failed()) html += case_html(picture);
    if (!result.frozen.empty()) html += "<section><h2>Frozen</h2>\n";
    for (const std::string& frozen : result.frozen)
        html += "<p class=\"figures\">" + markup_text(frozen) + "</p>\n";
    if (!result.frozen.empty()) html += "</section>\n";
    return html + kPageTail;
}

}  // namespace corda::golden
