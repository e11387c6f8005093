#pragma once

#include <string>
#include <string_view>

namespace corda {

/// Any bytes as the text or an attribute value in double quotes of XML and HTML.
[[nodiscard]] std::string markup_text(std::string_view text);

/// Base64 (RFC 4648), for addresses of pictures that are part of a page.
[[nodiscard]] std::string base64(std::string_view bytes);

/// The bytes of such a text; empty for another text.
[[nodiscard]] std::string from_base64(std::string_view text);

/// The style sheet of HTML pages, to be embedded. Light or dark follows the reader's system.
inline constexpr const char* kPageStyle = R"css(
:root {
  color-scheme: light dark;
  --ink: #1c2026; --soft: #5b6470; --line: #dde1e6; --page: #ffffff; --band: #f5f7f9;
  --accent: #0b5fa5; --bad: #b3261e; --bad-band: #fdf0ee;
}
@media screen and (prefers-color-scheme: dark) {
  :root {
    --ink: #e4e7eb; --soft: #9aa4b0; --line: #333a43; --page: #14171b; --band: #1c2126;
    --accent: #6cb6ff; --bad: #ff8f85; --bad-band: #33201f;
  }
}
* { box-sizing: border-box; }
body {
  margin: 0 auto; padding: 2.5rem 1.5rem 5rem; max-width: 70rem; background: var(--page); color: var(--ink);
  font: 1.0625rem/1.6 system-ui, "Segoe UI", "Helvetica Neue", Arial, sans-serif;
}
h1 { font-size: 2.1rem; line-height: 1.2; letter-spacing: -0.015em; margin: 0 0 1.5rem; text-wrap: balance; }
h2 { font-size: 1.5rem; line-height: 1.25; margin: 4rem 0 1rem; padding-top: 1.5rem; border-top: 1px solid var(--line); }
h2 a { color: inherit; text-decoration: none; }
h2 a:hover::after { content: " #"; color: var(--soft); }
p { margin: 0 0 1rem; max-width: 44rem; }
a { color: var(--accent); }
.summary { font-size: 1.125rem; margin: 0 0 0.6rem; }
nav { margin: 2rem 0; }
nav ol { margin: 0; padding-left: 1.4rem; }
details { margin: 1rem 0; }
summary { font-weight: 600; cursor: pointer; }
.scroll { overflow-x: auto; margin: 2rem 0 0.5rem; }
table { border-collapse: collapse; font-size: 0.9375rem; line-height: 1.4; font-variant-numeric: tabular-nums; }
caption { text-align: left; font-weight: 600; padding: 0 0 0.6rem; white-space: nowrap; }
th, td { padding: 0.35rem 0.7rem; text-align: left; vertical-align: top; }
th:first-child, td:first-child { padding-left: 0.6rem; }
thead th, thead .number { font-weight: 600; color: var(--soft); border-bottom: 2px solid var(--line); vertical-align: bottom; white-space: normal; }
tbody tr { border-bottom: 1px solid var(--line); }
tbody tr:nth-child(even) { background: var(--band); }
.number { text-align: right; }
td { white-space: nowrap; }
td.long { white-space: normal; min-width: 18rem; }
.missing { color: var(--soft); text-align: center; }
tbody tr.failed { background: var(--bad-band); color: var(--bad); }
.note { color: var(--soft); font-size: 0.9375rem; }
table.setting td { white-space: normal; }
table.setting th { font-weight: 500; color: var(--soft); white-space: nowrap; }
figure { margin: 2rem 0; padding: 0.5rem; border: 1px solid var(--line); border-radius: 8px; }
figure img { display: block; width: 100%; height: auto; }
figcaption { padding: 0.7rem 0.4rem 0.2rem; color: var(--soft); font-size: 0.9375rem; line-height: 1.45; }
figcaption b { color: var(--ink); }
figcaption .files { display: block; margin-top: 0.3rem; font-size: 0.875rem; }
.small { display: grid; grid-template-columns: repeat(auto-fill, minmax(20rem, 1fr)); gap: 1rem; margin: 2rem 0; }
.small figure { margin: 0; }
sup { line-height: 0; font-size: 0.75em; }
@media screen and (prefers-color-scheme: dark) { .white img { filter: invert(0.91) hue-rotate(180deg); } }
@media print {
  body { max-width: none; padding: 0; font-size: 10pt; }
  nav { display: none; }
  figure, tr { break-inside: avoid; }
  figure { margin: 3mm 0; }
  figure img { width: auto; max-width: 100%; max-height: 46mm; margin: 0 auto; }
  h2 { break-after: avoid; margin: 4mm 0 2mm; padding-top: 2mm; font-size: 14pt; }
  details::details-content { content-visibility: visible; block-size: auto; }
}
)css";

}  // namespace corda
