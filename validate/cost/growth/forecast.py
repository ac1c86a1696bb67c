"""What a larger size will cost, as smaller ones say: whether it is tried at all."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np


def foreseen(sizes: Sequence[float], costs: Sequence[float], size: float) -> float | None:
    """What a larger size will cost, carried on from the last two: the more of two laws.

    c size^p is right where a cost grows faster than its size; fixed + each size where a part that does not
    grow still hides the part that does.

    Returns:
        None if fewer than two sizes are known.
    """
    kept = [(known, cost) for known, cost in zip(sizes, costs, strict=True) if cost > 0.0]
    if len(kept) < 2:
        return None
    (smaller, less), (larger, more) = kept[-2:]
    exponent = max(np.log(more / less) / np.log(larger / smaller), 0.0)
    each = max((more - less) / (larger - smaller), 0.0)
    return float(max(more * (size / larger) ** exponent, more + each * (size - larger)))
