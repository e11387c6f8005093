#!/usr/bin/env python3
"""A table of a sweep by pandas: how the period grows with the amplitude.

Usage: table.py FOLDER, after `python3 -m corda sweep clips.toml -o FOLDER`
"""

import pathlib
import sys

import pandas

if __name__ == "__main__":
    table = pandas.read_csv(pathlib.Path(sys.argv[1]) / "metadata.csv", dtype={"key": str}, index_col="key")
    table = table[table["failure"].isna()]
    amplitude = pandas.cut(table["angle_max_deg"], range(0, 121, 30))
    print(table.pivot_table("period_s", amplitude, "world.gravity", observed=True))
