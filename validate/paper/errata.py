"""The paper's printed formulas that are wrong, and which quantities that spoils."""

from __future__ import annotations

from collections.abc import Collection

EQUATION_23 = (
    "eq. (23): rows 8-11 lack the factor 2 of a product's second derivative, and row 11 repeats points 7, 5"
)
QUOTIENT = "the printed quotient for omega is 0/0 when omega lies in the plane of points 5, 6, 7"

CAUSES = {
    "acceleration": EQUATION_23,
    "angular_velocity": QUOTIENT,
}


def erratum_of(quantity: str, wrong: Collection[str]) -> str:
    """The erratum behind a wrong quantity; the knuckle's alpha inherits from what it is made of.

    Args:
        wrong: all the quantities that are wrong in a scene.
    """
    if quantity == "angular_acceleration":
        parts = [CAUSES[q] for q in ("acceleration", "angular_velocity") if q in wrong]
        return "; ".join(parts) or QUOTIENT.replace("omega", "alpha")
    return CAUSES.get(quantity, "no known erratum: look into it")
