"""Pages of measurements: numbers and tables as Markdown, parts between marks, pictures as PNG.

A mark is a pair of comments, `<!-- begin of NAME -->` and `<!-- end of NAME -->`, around a part of a page that is written
by a program.
"""
import contextlib
import io
import math
import os
import pathlib
import platform
import re
import secrets
import textwrap
from typing import NamedTuple

ROOT = pathlib.Path(__file__).resolve().parents[2]


class Part(NamedTuple):
    """Markdown that belongs between the marks of a page.

    A page that has not got these marks leaves it out.
    """

    mark: str
    title: str
    markdown: str
    failures: tuple = ()  # why rows of it failed


class Picture(NamedTuple):
    """A figure of matplotlib, the name of its file and the caption below it."""

    name: str
    figure: object
    caption: str


class Chapter(NamedTuple):
    """What study.py makes of the measurements of a chapter."""

    title: str
    parts: list
    pictures: list


def number_text(value):
    """Three significant digits of a number, e.g. "1.23e-5" or "1230"; an integer in full; nothing for None and NaN."""
    if value is None or isinstance(value, float) and math.isnan(value):
        return ""
    if isinstance(value, int):
        return str(value)
    text = f"{value:.3g}"
    if 1e3 <= abs(float(text)) < 1e6:
        text = f"{float(text):.0f}"
    return re.sub(r"e([+-])0", r"e\1", text)


def escaped(text):
    """A text without what Markdown would take for markup, on one line."""
    return re.sub(r"([\\`*_\[\]<>|~$&])", r"\\\1", " ".join(text.split()))


def is_number(cell):
    return isinstance(cell, (int, float)) and not isinstance(cell, bool)


def table_text(heads, rows):
    """A table in Markdown. Cells are numbers, texts or None; columns of numbers are aligned to the right."""
    def aligned(column):
        cells = [row[column] for row in rows if row[column] is not None]
        return "---:" if cells and all(map(is_number, cells)) else "---"

    def cell_text(cell):
        return escaped(cell) if isinstance(cell, str) else number_text(cell)

    lines = ["| " + " | ".join(map(escaped, heads)) + " |", "|" + "|".join(map(aligned, range(len(heads)))) + "|"]
    lines += ["| " + " | ".join(map(cell_text, row)) + " |" for row in rows]
    return "\n".join(lines)


def paragraph(text):
    """A text in lines of 120 characters at most."""
    return textwrap.fill(text, 120, break_long_words=False, break_on_hyphens=False)


def table(mark, title, columns, records, note=""):
    """A Part with one row per record, a dict.

    `columns` are pairs of a head and the key of its values. If a record has a "failure", a last column says why.
    """
    failures = tuple(record["failure"] for record in records if record.get("failure"))
    if failures:
        columns = [*columns, ("failed because", "failure")]
    rows = [[record.get(key) for _, key in columns] for record in records]
    text = table_text([head for head, _ in columns], rows)
    return Part(mark, title, text + (f"\n\n{paragraph(note)}" if note else ""), failures)


def marks_of(text):
    """The names of the marks in the text of a page."""
    return re.findall(r"<!-- begin of (.*?) -->", text)


def put(text, part):
    """The text of a page with a part between its marks; unchanged if the page has not got them."""
    marked = re.compile(rf"(<!-- begin of {re.escape(part.mark)} -->\n).*?(\n<!-- end of {re.escape(part.mark)} -->)",
                        re.DOTALL)
    return marked.sub(lambda found: f"{found[1]}\n{part.markdown}\n{found[2]}", text)


def page_text(title, chapters):
    """A page of its own with all parts and pictures of chapters."""
    lines = [f"# {escaped(title)}"]
    for chapter in chapters:
        lines.append(f"## {chapter.title}")
        parts = [(f"### {escaped(part.title)}\n\n" if part.title else "") + part.markdown for part in chapter.parts]
        lines += [f"![{escaped(picture.caption)}]({picture.name})\n\n*{escaped(picture.caption)}*"
                  for picture in chapter.pictures if not any(f"({picture.name})" in part for part in parts)]
        lines += parts
    return "\n\n".join(lines) + "\n"


def replace_file(path, data):
    """Writes bytes or a text to a temporary file and renames it, so that the file under its own name is always complete."""
    temporary = path.with_name(f"{path.name}.{secrets.token_hex(4)}.tmp")
    try:
        temporary.write_bytes(data.encode("utf-8") if isinstance(data, str) else data)
        os.replace(temporary, path)
    finally:
        with contextlib.suppress(OSError):
            temporary.unlink(missing_ok=True)


def save_picture(picture, folder):
    """Writes a picture as PNG, 80 pixels per inch."""
    from PIL import Image  # which comes with matplotlib

    drawn = io.BytesIO()
    picture.figure.savefig(drawn, format="png", dpi=80, bbox_inches="tight")
    with Image.open(drawn) as image:  # fewer colours take a third of the bytes
        packed = io.BytesIO()
        image.convert("RGB").quantize(96).save(packed, format="png", optimize=True)
    replace_file(folder / picture.name, packed.getvalue())


def processor():
    """The processor's name."""
    try:
        with open("/proc/cpuinfo", encoding="utf-8") as file:
            names = [line.split(":", 1)[1].strip() for line in file if line.startswith("model name")]
    except OSError:
        names = []
    return names[0] if names else platform.machine()
