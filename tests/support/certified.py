"""Certificates of poses that share no inverse."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from pointcoord.numerics.enclosure import Enclosed
from pointcoord.numerics.kantorovich import Certificate, certify
from pointcoord.numerics.linear import factorise
from pointcoord.numerics.quadratic import QuadraticMap

Array = NDArray[np.float64]


def certify_alone(system: QuadraticMap, y: Array, data: Array | None = None) -> Certificate:
    """The certificate of poses of shape (..., size), each by its own inverse."""
    data = np.zeros_like(y) if data is None else data
    pose = Enclosed.of(y[..., None, :], 0.0, data[..., None, :])
    found = certify(system, pose, factorise(system.jacobian(y)))
    return replace(
        found,
        **{name: getattr(found, name)[..., 0] for name in ("radius", "unique_within", "contraction", "tail")},
        **{name: getattr(found, name)[..., 0, :] for name in ("residual", "step", "spread")},
    )
