r"""Numbers with a derivative, stored as complex numbers x + x' h i, with h so small that h^2 is 0 in doubles.

    (a + a' h i)(b + b' h i) = a b + (a b' + a' b) h i,      f(a + a' h i) = f(a) + f'(a) a' h i

for sums, products, quotients and roots. So a formula for floats that consists of these also gives its
derivative, exact to rounding, for such numbers; `<` compares them by value first. Moduli and conjugates are
not differentiated this way, and must not occur in such a formula (Squire and Trapp, *Using complex variables
to estimate derivatives of real functions*, SIAM Review 40, 1998).
"""

from __future__ import annotations

from typing import cast

from pointcoord.numerics.arrays import Array

H = 2.0**-600


def with_slope(value: Array, slope: Array) -> Array:
    """Numbers and their derivatives as one array, which is complex in spite of its type annotation."""
    return cast("Array", value + 1j * (H * slope))


def slope_of(number: Array) -> Array:
    """The derivatives of numbers; zero for floats."""
    return number.imag / H
