"""Areas of a grid: a mask grown by its neighbours, and the connected piece around a cell."""

from __future__ import annotations

import numpy as np

from app.science.arrays import BoolArray


def widened(mask: BoolArray, steps: int = 1) -> BoolArray:
    """Return the mask and what lies up to ``steps`` cells from it, sideways or up and down; same shape."""
    for _ in range(steps):
        wider = mask.copy()
        wider[1:] |= mask[:-1]
        wider[:-1] |= mask[1:]
        wider[:, 1:] |= mask[:, :-1]
        wider[:, :-1] |= mask[:, 1:]
        mask = wider
    return mask


def piece_around(mask: BoolArray, i: int, j: int) -> BoolArray:
    """Return the connected piece of a mask that holds cell (i, j); cells touch at their sides."""
    piece = np.zeros_like(mask)
    piece[i, j] = mask[i, j]
    size = -1
    while size != (size := int(piece.sum())):
        piece = widened(piece) & mask
    return piece
