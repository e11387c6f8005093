"""The page of a report: HTML, which is also well-formed XML, without scripts; it needs no other file."""

import base64
import html
import string

from . import _corda
from ._chapters import short_number

_PAGE = string.Template("""<!DOCTYPE html>
<html xmlns="http://www.w3.org/1999/xhtml" lang="en">
<head>
<meta charset="utf-8"/>
<meta name="viewport" content="width=device-width, initial-scale=1"/>
<title>$title</title>
<style>$style</style>
</head>
<body>
<h1>$title</h1>
$summaries
<nav aria-label="Chapters">
<ol>
$contents
</ol>
</nav>
$setting
$chapters
</body>
</html>
""")

_FIGURE = string.Template("""<figure id="figure-$id"$white>
<img alt="$title" src="data:image/svg+xml;base64,$svg"/>
<figcaption><b>Figure $number.</b> $caption<span class="files">$files</span></figcaption>
</figure>
""")


class Page:
    """Writes a page. `svgs`: the bytes of each figure's SVG by its id; figures without are left out. `language`: of the
    decimal sign of numbers in tables."""

    def __init__(self, widths_mm, svgs, language):
        self.widths_mm = widths_mm
        self.svgs = svgs
        self.language = language
        self.count = 0

    def html(self, title, chapters, setting_title, setting):
        """The page; `setting`: pairs of a name and a value."""
        numbered = list(enumerate(chapters, 1))
        return _PAGE.substitute(
            title=_text(title), style=_corda.page_style,
            summaries="\n".join(f'<p class="summary">{_text(c.summary)}</p>' for c in chapters if c.summary),
            contents="\n".join(f'<li><a href="#chapter-{n}">{_text(c.title)}</a></li>' for n, c in numbered),
            setting=_setting(setting_title, setting),
            chapters="\n".join(self._chapter(n, chapter) for n, chapter in numbered))

    def _chapter(self, number, chapter):
        parts = [f'<section id="chapter-{number}">',
                 f'<h2><a href="#chapter-{number}">{number}. {_text(chapter.title)}</a></h2>']
        parts += [f"<p>{_text(paragraph)}</p>" for paragraph in chapter.paragraphs]
        is_in_row = False
        for figure in chapter.figures:
            if figure.id not in self.svgs:
                continue
            if figure.is_small != is_in_row:
                parts.append('<div class="small">' if figure.is_small else "</div>")
            is_in_row = figure.is_small
            parts.append(self._figure(figure))
        parts += ["</div>"] * is_in_row
        parts += [self._table(table) for table in chapter.tables]
        return "\n".join([*parts, "</section>"])

    def _figure(self, figure):
        self.count += 1
        files = " · ".join(f"{width} mm: " + " ".join(f'<a href="{figure.id}_{width}mm.{ending}">{ending.upper()}</a>'
                                                      for ending in ("svg", "pdf", "png")) for width in self.widths_mm)
        if figure.data:
            files += f' · numbers: <a href="{figure.data}">CSV</a>'
        return _FIGURE.substitute(id=figure.id, white=' class="white"' if figure.is_on_white else "", title=_text(figure.title),
                                  svg=base64.b64encode(self.svgs[figure.id]).decode(), number=self.count,
                                  caption=_text(figure.caption), files=files)

    def _table(self, table):
        head = "".join(f'<th scope="col"{_number_class(table, k)}>{_text(title)}</th>' for k, title in enumerate(table.titles))
        rows = "".join(f"<tr>{''.join(map(self._cell, row))}</tr>\n" for row in table.rows)
        note = f'<p class="note">{_text(table.note)}</p>\n' if table.note else ""
        return (f'<details>\n<summary>{_text(table.title)}</summary>\n<div class="scroll">\n<table id="table-{table.id}">\n'
                f"<thead><tr>{head}</tr></thead>\n<tbody>\n{rows}</tbody>\n</table>\n</div>\n{note}</details>")

    def _cell(self, cell):
        if isinstance(cell, float):
            sign = "." if self.language == 0 else ","
            digits, e, exponent = short_number(cell).replace(".", sign).partition("e")
            power = f"·10<sup>{exponent.replace('-', '−')}</sup>" if e else ""
            return f'<td class="number" title="{f"{cell:.17g}".replace(".", sign)}">{digits}{power}</td>'
        if cell:
            return f'<td class="{"long" if len(cell) > 40 else "text"}">{_text(cell)}</td>'
        return '<td class="missing">–</td>'


def _text(text):
    return html.escape(text)


def _number_class(table, column):
    return ' class="number"' if any(isinstance(row[column], float) for row in table.rows) else ""


def _setting(title, setting):
    rows = "\n".join(f'<tr><th scope="row">{_text(name)}</th><td>{_text(value)}</td></tr>' for name, value in setting)
    return (f'<div class="scroll">\n<table class="setting" id="setting">\n<caption>{_text(title)}</caption>\n<tbody>\n{rows}\n'
            "</tbody>\n</table>\n</div>")
