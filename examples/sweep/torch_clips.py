#!/usr/bin/env python3
"""Batches of clips for PyTorch, made while they are read: no files. The sampler may shuffle them, or be a DistributedSampler.

Usage: torch_clips.py clips.toml
"""

import sys

import torch
from torch.utils.data import DataLoader, Dataset

import corda


class Clips(Dataset):
    def __init__(self, path):
        self.sweep = corda.Sweep(path)

    def __len__(self):
        return len(self.sweep)

    def __getitem__(self, i):
        sample = self.sweep[i]
        clip = torch.from_numpy(sample["frames"][..., :3]).permute(0, 3, 1, 2)  # frames, channels, height, width
        return clip, torch.from_numpy(sample["pixels"][:, -1]), sample["parameters"]["world.gravity"]


if __name__ == "__main__":
    for clips, tips, gravity in DataLoader(Clips(sys.argv[1]), batch_size=8, shuffle=True, num_workers=2):
        print(tuple(clips.shape), tuple(tips.shape), gravity.tolist())
