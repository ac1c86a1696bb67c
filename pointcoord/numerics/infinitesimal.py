r"""Numbers with a slope as complex ones: x + x' h i, with h so small that h^2 is 0 in doubles.

    (a + a' h i)(b + b' h i) = a b + (a b' + a' b) h i,      f(a + a' h i) = f(a) + f'(a) a' h i

for sums, products, quotients and roots. So a formula in floats that is made of these gives its derivative,
exact to rounding, if it is given such numbers; `<` compares them by their values first. A modulus or a
conjugate has no derivative this way, and nothing that is to have one may be made of it (Squire and Trapp,
*Using complex variables to estimate derivatives of real functions*, SIAM Review 40, 1998).
"""

from __future__ import annotations

from typing import cast

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

H = 2.0**-600


def with_slope(value: Array, slope: Array) -> Array:
    """Numbers and their slopes as one array, which is complex whatever its type says."""
    return cast("Array", value + 1j * (H * slope))


def slope_of(number: Array) -> Array:
    """What numbers have for slopes; none of floats."""
    return number.imag / H
