#!/usr/bin/env python3
"""Batches of clips for PyTorch, made while they are read: no files, and each worker makes its own share.

Usage: torch_clips.py clips.toml
"""

import sys

import torch
from torch.utils.data import DataLoader, IterableDataset, get_worker_info

import corda


class Clips(IterableDataset):
    def __init__(self, path):
        self.path = path

    def __iter__(self):
        worker = get_worker_info()
        for sample in corda.sweep(self.path, shard=(worker.id, worker.num_workers) if worker else None):
            clip = torch.from_numpy(sample["frames"][..., :3]).permute(0, 3, 1, 2)  # frames, channels, height, width
            tip = torch.from_numpy(sample["pixels"][:, -1])
            yield clip, tip, sample["parameters"]["world.gravity"]


if __name__ == "__main__":
    for clips, tips, gravity in DataLoader(Clips(sys.argv[1]), batch_size=8, num_workers=2):
        print(tuple(clips.shape), tuple(tips.shape), gravity.tolist())
