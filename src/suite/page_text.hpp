#pragma once

namespace corda::suite {

/// The head of the page. Light or dark follows the reader's system.
inline constexpr const char* kPageHead = R"html(<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>Golden pictures</title>
<style>
:root { color-scheme: light dark; --ink: #1c2026; --soft: #5b6470; --line: #dde1e6; --page: #fff; --bad: #b3261e; }
@media (prefers-color-scheme: dark) {
  :root { --ink: #e4e7eb; --soft: #9aa4b0; --line: #333a43; --page: #14171b; --bad: #ff8f85; }
}
body { margin: 0 auto; padding: 2rem 1.5rem 4rem; max-width: 80rem; background: var(--page); color: var(--ink);
  font: 1rem/1.5 system-ui, "Segoe UI", Arial, sans-serif; }
h1 { font-size: 1.8rem; margin: 0 0 .5rem; }
h2 { font-size: 1.1rem; margin: 0; overflow-wrap: anywhere; }
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
figure { margin: 0; }
figcaption { color: var(--soft); font-size: .875rem; }
img { display: block; max-width: 100%; height: auto; image-rendering: pixelated;
  background: repeating-conic-gradient(#bbb 0 25%, #eee 0 50%) 0 0 / 16px 16px; }
.blink .pictures, .slide .pictures { display: grid; justify-content: start; }
.blink figure, .slide figure { grid-area: 1 / 1; }
.blink .difference, .slide .difference { grid-area: 1 / 2; }
.blink.now .reference, .blink:not(.now) .drawn { visibility: hidden; }
.slide .drawn img { clip-path: inset(0 0 0 var(--cut, 50%)); }
.slide .drawn figcaption { visibility: hidden; }
.slide .reference figcaption::after { content: " on the left, new on the right"; }
</style>
</head>
<body>
)html";

/// What stands above the pictures of a case that has both.
inline constexpr const char* kPageModes = R"html(<div class="modes">
<button data-mode="" aria-pressed="true">beside each other</button>
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

}  // namespace corda::suite
