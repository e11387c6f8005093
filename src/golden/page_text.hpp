#pragma once

namespace corda::golden {

/// The head of the page, with two style sheets to be filled in.
inline constexpr const char* kPageHead = R"html(<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>Golden pictures</title>
<style>{}{}</style>
</head>
<body>
)html";

inline constexpr const char* kPicturesStyle = R"css(
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
inline constexpr const char* kPageModes = R"html(<div class="modes">
<button data-mode="" aria-pressed="true">side by side</button>
<button data-mode="blink" aria-pressed="false">blink</button>
<button data-mode="slide" aria-pressed="false">slider</button>
<input type="range" min="0" max="100" value="50" aria-label="where the reference ends and the new picture begins">
</div>
)html";

/// The end of the page.
inline constexpr const char* kPageTail = R"html(<script>
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

}  // namespace corda::golden
