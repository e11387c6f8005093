#!/usr/bin/env python3
"""Copies the plots and the tables of a study to src/corda/study/README.md.

Usage: corda study -o STUDY --chapter accuracy --chapter speed && src/cmake/readme_tables.py STUDY
       tests/benchmark/run.sh study -o STUDY && src/cmake/readme_tables.py STUDY

Each table stands between two marks and keeps its header; its rows become those of the CSV file. A chapter that the folder
lacks stays as it is.
"""
import csv
import pathlib
import re
import shutil
import sys

# Tables and pictures by chapter; a folder with the first table has all of them.
CHAPTERS = [
    ({"Fastest at each accuracy": "fastest_report_swing.csv", "Setting": "setting.csv"},
     {"speed_report_swing.png": "speed.png"}),
    ({"Accuracy against published numbers": "accuracy.csv"}, {}),
    ({"XPBD and Corda on four pendulums": "challenge.csv", "Time at equal error": "challenge_ratios.csv",
      "Lines of code": "challenge_lines.csv", "Setting of the challenge": "setting.csv"},
     {f"challenge_{name}.png": f"challenge_{name}.png" for name in ("three", "masses", "ten", "forty")}),
    ({"Predicted and observed horizons": "horizons.csv"}, {"horizons.png": "horizons.png"}),
]


def cell_text(cell):
    """Three digits of a number; of a text, what Markdown would take for markup escaped."""
    try:
        value = float(cell)
    except ValueError:
        return re.sub(r"([\\`*_\[\]<>|~$&])", r"\\\1", cell)
    text = f"{value:.3g}"
    if 1e3 <= abs(float(text)) < 1e6:
        text = f"{float(text):.0f}"
    return re.sub(r"e([+-])0", r"e\1", text)


def rows_of(path):
    with open(path, newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    failed = [row for row in rows if row.pop("failure", "")]
    if failed:
        sys.exit(f"readme_tables.py: {path} has failed rows: {failed}")
    return "".join("| " + " | ".join(map(cell_text, row.values())) + " |\n" for row in rows)


def main():
    if len(sys.argv) != 2:
        sys.exit("usage: readme_tables.py STUDY")
    study = pathlib.Path(sys.argv[1])
    page = pathlib.Path(__file__).resolve().parent.parent / "study" / "README.md"
    text = page.read_text(encoding="utf-8")
    found_any = False
    for tables, pictures in CHAPTERS:
        if not (study / next(iter(tables.values()))).exists():
            continue
        found_any = True
        for title, name in tables.items():
            table = re.compile(rf"(<!-- begin of {title} -->\n\n\|.*\n\|.*\n)(?:\|.*\n)*(\n<!-- end of {title} -->)")
            rows = rows_of(study / name)
            text, count = table.subn(lambda found, rows=rows: found[1] + rows + found[2], text)
            if count != 1:
                sys.exit(f'readme_tables.py: {page} has no table "{title}"')
        for source, target in pictures.items():
            shutil.copyfile(study / source, page.parent / target)
    if not found_any:
        sys.exit(f"readme_tables.py: {study} has none of the tables")
    page.write_text(text, encoding="utf-8")


main()
