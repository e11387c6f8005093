from collections.abc import Sequence

from . import Sweep as Sweep

__all__ = ["Sweep"]

def main(argv: Sequence[str]) -> int: ...
