#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>

#include "corda/core/file.hpp"
#include "corda/core/markup.hpp"
#include "corda/core/text.hpp"
#include "corda/golden/suite.hpp"
#include "corda/media/bytes.hpp"

namespace corda::golden {
namespace {

/// The head of the page, with two style sheets to be filled in.
constexpr const char* kPageHead = R"html(<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>Golden pictures</title>
<style>{}{}</style>
</head>
<body>
)html";

constexpr const char* kPicturesStyle = R"css(
body { max-width: 80rem; }
h2 { font-size: 1.1rem; margin: 0; padding: 0; border: 0; overflow-wrap: anywhere; }
section { border-top: 1px solid var(--line); margin-top: 1.5rem; padding-top: 1.2rem; }
.cause { color: var(--bad); margin: .2rem 0; }
.figures { color: var(--soft); margin: .2rem 0 .8rem; font-variant-numeric: tabular-nums; }
.modes { display: flex; flex-wrap: wrap; gap: .5rem; align-items: center; margin-bottom: .8rem; }
button { font: inherit; padding: .15rem .8rem; border: 1px solid var(--line); border-radius: .3rem;
  background: none; color: inherit; cursor: pointer; }
button[aria-pressed=true] { border-color: var(--ink); font-weight: 600; }
input[type=range] { width: 16rem; visibility: hidden; }
.slide input[type=range] { visibility: visible; }
.pictures { display: flex; flex-wrap: wrap; gap: 1rem; }
.pictures figure { margin: 0; padding: 0; border: 0; }
img { display: block; max-width: 100%; height: auto; image-rendering: pixelated;
  background: repeating-conic-gradient(#bbb 0 25%, #eee 0 50%) 0 0 / 16px 16px; }
.blink .pictures, .slide .pictures { display: grid; justify-content: start; }
.blink figure, .slide figure { grid-area: 1 / 1; }
.blink .difference, .slide .difference { grid-area: 1 / 2; }
.blink.now .reference, .blink:not(.now) .drawn { visibility: hidden; }
.slide .drawn img { clip-path: inset(0 0 0 var(--cut, 50%)); }
.slide .drawn figcaption { visibility: hidden; }
.slide .reference figcaption::after { content: " on the left, new on the right"; }
)css";

/// The controls above a pair of pictures.
constexpr const char* kPageModes = R"html(<div class="modes">
<button data-mode="" aria-pressed="true">side by side</button>
<button data-mode="blink" aria-pressed="false">blink</button>
<button data-mode="slide" aria-pressed="false">slider</button>
<input type="range" min="0" max="100" value="50" aria-label="where the reference ends and the new picture begins">
</div>
)html";

/// The end of the page.
constexpr const char* kPageTail = R"html(<script>
const kBlinkMs = 500;
for (const section of document.querySelectorAll("section")) {
  const buttons = section.querySelectorAll("button");
  for (const button of buttons) {
    button.addEventListener("click", () => {
      section.classList.remove("blink", "slide", "now");
      if (button.dataset.mode) section.classList.add(button.dataset.mode);
      for (const other of buttons) other.setAttribute("aria-pressed", other === button);
    });
  }
  const range = section.querySelector("input");
  if (range) range.addEventListener("input", () => section.style.setProperty("--cut", range.value + "%"));
}
setInterval(() => {
  for (const section of document.querySelectorAll("section.blink")) section.classList.toggle("now");
}, kBlinkMs);
</script>
</body>
</html>
)html";

constexpr int kGain = 16;  // of the difference: one step of 255 is seen

std::string figure_html(const char* kind, const std::string& caption, const Image& image) {
    return fmt::format(
        "<figure class=\"{}\"><img alt=\"{}\" width=\"{}\" height=\"{}\" "
        "src=\"data:image/png;base64,{}\"><figcaption>{}</figcaption></figure>\n",
        kind, caption, image.width(), image.height(), base64(media::png_bytes(image, {})), caption);
}

std::string case_html(const Checked& picture) {
    std::string html =
        fmt::format("<section id=\"{0}\">\n<h2>{0}</h2>\n<p class=\"cause\">{1}</p>\n",
                    markup_text(picture.name), markup_text(cause_text(picture).whole_or_group()));
    if (picture.difference) html += fmt::format("<p class=\"figures\">{}</p>\n", figures_text(picture));
    const bool is_shown = picture.drawn || picture.verdict() == Verdict::kStale;
    std::optional<Image> reference;
    try {
        if (is_shown && !picture.reference.empty()) reference = read_png(picture.reference);
    } catch (const Error&) {  // the cause says it
    }
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
    const PixelRect both = a.rect().intersected(b.rect());
    for (int y = 0; y < result.height(); ++y) {
        for (int x = 0; x < result.width(); ++x) {
            std::uint8_t* const to = result.pixel(x, y);
            to[3] = 255;
            if (x >= both.x1 || y >= both.y1) {
                to[2] = 255;
                continue;
            }
            const auto difference = [p = a.pixel(x, y), q = b.pixel(x, y)](int c) {
                return std::abs(p[c] - q[c]);
            };
            for (int c = 0; c < 3; ++c)
                to[c] =
                    static_cast<std::uint8_t>(std::min(255, kGain * std::max(difference(3), difference(c))));
        }
    }
    return result;
}

std::string html_report(const SuiteResult& result) {
    const std::int64_t failed = std::ranges::count_if(result.pictures, &Checked::failed);
    std::string html = fmt::format(kPageHead, kPageStyle, kPicturesStyle);
    html += fmt::format("<h1>Golden pictures: {} failed</h1>\n<p>{}. Drawn by corda {}.</p>\n", failed,
                        result.totals(), version());
    for (const Checked& picture : result.pictures)
        if (picture.failed()) html += case_html(picture);
    return html + kPageTail;
}

}  // namespace corda::golden
