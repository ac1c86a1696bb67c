"""A hard case: why it is hard, a parameter that leads into it, and what has to come of it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

# right: every number lies within its bound of the reference. refused: a reason in place of numbers. noted:
# some numbers are out of their bounds, and the formulation itself says so. wrong: it does not say so.
# unjudged: the reference could not be proven, which is a failure of the catalogue unless the case allows it.
Outcome = Literal["right", "refused", "noted", "wrong", "unjudged"]

OURS = "pointcoord"


@dataclass(frozen=True)
class Answer:
    """What one formulation made of one value of the parameter.

    Attributes:
        formulation: its name.
        outcome: held to the reference.
        reason: of a refusal; else which quantity came closest to its bound, or exceeded it the most.
        error: largest distance of a point from the reference, in the case's unit; None without numbers.
        bound: largest bound that the formulation gives for it, in the same unit.
        share: largest error of any quantity, rates and angles too, in parts of its bound.
        condition: largest condition number.
    """

    formulation: str
    outcome: Outcome
    reason: str = ""
    error: float | None = None
    bound: float | None = None
    share: float | None = None
    condition: float | None = None


@dataclass(frozen=True)
class Trial:
    """One value of a parameter, tried by every formulation of the case.

    Attributes:
        facts: what else was measured there, by name with its unit.
        judge: holds the answer of another formulation for the same scene to the same reference; None where
            there is no one scene, or nothing to hold an answer to.
    """

    value: float
    answers: tuple[Answer, ...]
    facts: Mapping[str, float | str] = field(default_factory=dict)
    judge: Callable[[str], Answer] | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True)
class Expected:
    """What a formulation may make of a case.

    Attributes:
        outcomes: those allowed.
        right_from, right_to: for values of the parameter from here up, and from here down, only `right` is
            allowed.
    """

    outcomes: tuple[Outcome, ...]
    right_from: float = float("inf")
    right_to: float = float("-inf")

    @property
    def words(self) -> str:
        """In words."""
        surely = [f"right from {self.right_from:g} up"] if self.right_from < float("inf") else []
        surely += [f"right up to {self.right_to:g}"] if self.right_to > float("-inf") else []
        return "; ".join((" or ".join(self.outcomes), *surely))

    def met(self, value: float, outcome: Outcome) -> bool:
        """Whether an outcome is what had to come."""
        surely = value >= self.right_from or value <= self.right_to
        return outcome in (("right",) if surely else self.outcomes)


@dataclass(frozen=True)
class Case:
    """One entry of the catalogue.

    Attributes:
        name: on the command line, words joined by hyphens.
        group: heading that it is shown under.
        why: one sentence that says why it is hard.
        parameter: what tends to the singular place, with its unit.
        values: of the parameter, evenly spaced in its logarithm.
        expected: by formulation; a case tries the formulations named here.
        behaviour: what is expected, in words.
        examine: tries one value.
        unit: of error and bound.
        content: of the scene at a value, of a case whose trial is one scene; for whoever has another solver
            to try on it.
        without_pose: whether some instants of that scene have no pose, at every value.
        also_answered: values at which the scene has an answer although `expected` allows a refusal as well;
            they need not be among those that are tried.
    """

    name: str
    group: str
    why: str
    parameter: str
    values: tuple[float, ...]
    expected: Mapping[str, Expected]
    behaviour: str
    examine: Callable[[float], Trial]
    unit: str = "mm"
    content: Callable[[float], Mapping[str, Any]] | None = None
    without_pose: bool = False
    also_answered: tuple[float, ...] = ()

    @property
    def answered(self) -> tuple[float, ...]:
        """The values at which the scene has an answer that any solver can be held to."""
        if self.content is None or self.without_pose:
            return ()
        expected = self.expected.get(OURS) or next(iter(self.expected.values()))
        needed = (v for v in self.values if expected.met(v, "right") and not expected.met(v, "refused"))
        return tuple(dict.fromkeys((*needed, *self.also_answered)))


def described(expected: Mapping[str, Expected]) -> str:
    """What is expected of formulations, in words: who shares it named once."""
    alike: dict[str, list[str]] = {}
    for name, one in expected.items():
        alike.setdefault(one.words, []).append(name)
    if len(alike) == 1:
        return next(iter(alike))
    return "; ".join(f"{', '.join(names)}: {words}" for words, names in alike.items())


def decades(low: int = -12, high: int = 0) -> tuple[float, ...]:
    """One value per decade, going in: from 10^high down to 10^low."""
    return tuple(float(f"1e{k}") for k in range(high, low - 1, -1))


def coarse(values: tuple[float, ...]) -> tuple[float, ...]:
    """Every fourth value and the last: what a case tries of a second suspension."""
    return tuple(dict.fromkeys((*values[::4], values[-1])))


def unexpected(case: Case, trial: Trial) -> tuple[Answer, ...]:
    """The answers of a trial that the case does not allow."""
    return tuple(a for a in trial.answers if not case.expected[a.formulation].met(trial.value, a.outcome))


def wrong_without_warning(trial: Trial) -> tuple[Answer, ...]:
    """Wrong numbers that their formulation gave as right; the printed formulas are there to be wrong."""
    return tuple(a for a in trial.answers if a.outcome == "wrong" and a.formulation != "printed")


RIGHT = Expected(("right",))
RIGHT_OR_REFUSED = Expected(("right", "refused"))
REFUSED = Expected(("refused",))
# Of mechanisms that a model may refuse, and of which there may be no reference: then nothing is judged.
IF_ANY = Expected(("right", "refused", "unjudged"))
FAILS = Expected(("refused", "noted", "wrong"))
