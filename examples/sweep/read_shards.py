#!/usr/bin/env python3
"""The labels in the shards of a sweep, by tarfile and numpy alone.

Usage: read_shards.py FOLDER, after `python3 -m corda sweep clips.toml -o FOLDER`
"""

import io
import json
import pathlib
import sys
import tarfile

import numpy as np


def samples(folder):
    """Pairs: what the .json of a sample says, and its arrays by name."""
    for path in sorted(pathlib.Path(folder).glob("shard-*.tar")):
        with tarfile.open(path) as shard:
            for entry in shard:
                if entry.name.endswith(".json"):
                    info = json.load(shard.extractfile(entry))
                elif entry.name.endswith(".npz"):  # the last file of a sample
                    yield info, np.load(io.BytesIO(shard.extractfile(entry).read()))


if __name__ == "__main__":
    for info, arrays in samples(sys.argv[1]):
        print(info["key"], info["split"], info["error_estimate_px"], arrays["positions"].shape, arrays["mask"].shape)
