#!/usr/bin/env python3
"""Runs the shards of a corda command on a Dask cluster, then joins them.

Usage: dask_shards.py SHARDS COMMAND...
DASK_SCHEDULER_ADDRESS names the cluster's scheduler; without it, the workers are processes of this machine.
"""

import os
import subprocess
import sys

from distributed import Client

if __name__ == "__main__":
    shards, command, folder = int(sys.argv[1]), sys.argv[2:], os.getcwd()

    def make(shard):
        subprocess.run([*command, "--shard", f"{shard}/{shards}"], cwd=folder, check=True)

    with Client() as client:
        client.gather(client.map(make, range(shards), pure=False, retries=3))
    sys.exit(subprocess.run([*command, "--resume"]).returncode)
