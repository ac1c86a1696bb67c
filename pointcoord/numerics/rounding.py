"""Rounding constants of doubles."""

import numpy as np

EPS = float(np.finfo(float).eps)
"""Distance from 1 to the next double, 2^-52."""

UNIT_ROUNDOFF = EPS / 2
"""u = 2^-53: a sum, product, quotient or root has a rounding error of at most u of itself."""
