"""The paper's errata (see `errata.toml`): the quantities that they make wrong, and their effect in numbers.

Two errata make a quantity of a scene wrong: the factor in eq. (23) and the quotient for omega. Their effect
is also measured for each scene that is solved with the formulas as printed (see `comparison.findings`).
"""

from __future__ import annotations

import tomllib
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class Erratum:
    """One erratum.

    Attributes:
        where: place in the paper. wrong: what is wrong there.
        measures: its effect in numbers; empty for a misprint that changes no number.
        spoils: the quantity whose printed formula is wrong. cause: the text printed beside its wrong numbers.
    """

    where: str
    wrong: str
    measures: str = ""
    spoils: str = ""
    cause: str = ""


_KNOWN = tomllib.loads(Path(__file__).with_name("errata.toml").read_text(encoding="utf-8"))["errata"]
ERRATA = tuple(Erratum(**one) for one in _KNOWN)
"""All of them, in the order in which the project counts them."""
CAUSES: Mapping[str, str] = {one.spoils: one.cause for one in ERRATA if one.spoils}


def erratum_of(quantity: str, wrong: Collection[str]) -> str:
    """The erratum that explains a wrong quantity; the knuckle's alpha inherits the errors of its terms.

    Args:
        wrong: all the quantities that are wrong in a scene.
    """
    if quantity == "angular_acceleration":
        parts = [CAUSES[q] for q in ("acceleration", "angular_velocity") if q in wrong]
        return "; ".join(parts) or CAUSES["angular_velocity"].replace("omega", "alpha")
    return CAUSES.get(quantity, "no known erratum: look into it")
