"""Which assembly a drawing, or a pose, is: the signs of its choices."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from validate.reference.errors import AmbiguousAssemblyError, NotDecidedError
from validate.reference.linkage import Candidate, Choices, Known, Linkage
from validate.reference.vectors import Vector

CLEAR_SIGN = 1e-9  # a given table is rounded to a float and need not be assembled: closer is noise


def every_candidate(known: Known) -> Iterator[Candidate]:
    """The closed form of every combination of the choices."""
    for choices in known.linkage.combinations(known):
        yield known.linkage.candidate(known, choices)


def choices_of(points: Mapping[str, Vector], known: Known) -> Choices:
    """The proven choices of an assembly given as balls.

    Raises:
        NotDecidedError: a sign is not certain with the present digits.
    """
    signs = {}
    for name, (value, _) in known.linkage.posed_sides(points, known).items():
        if not (value > 0 or value < 0):
            raise NotDecidedError(f"the sign of the {name} choice", value, "not 0")
        signs[name] = 1 if value > 0 else -1
    return known.linkage.choices(**signs)


def choices_of_table(
    table: Mapping[str, Vector], up: Vector, linkage: Linkage, clearness: float = CLEAR_SIGN
) -> Choices:
    """The choices that the given points make, which need not be assembled; fractions.

    Args:
        clearness: how far from where two assemblies meet the table must be, as a sine; 0 takes every
            sign that is not exactly zero.
    Raises:
        AmbiguousAssemblyError: the table lies (nearly) at a dead point or toggle.
    """
    signs = {}
    for name, (value, scale2) in linkage.drawn_sides(table, up).items():
        clear = float(value * value / scale2) ** 0.5 if scale2 else 0.0
        if value == 0 or clear < clearness:
            remedy = "the given points lie at a singular pose; say which assembly is wanted by a guess"
            raise AmbiguousAssemblyError(f"the sign of the {name} choice", clear, clearness, remedy)
        signs[name] = 1 if value > 0 else -1
    return linkage.choices(**signs)
