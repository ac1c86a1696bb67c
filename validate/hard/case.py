"""A hard case is a row: why it is hard, a scene made from one number that leads into it, what has to come.

A family is such a row for every mechanism. The struts, on and beside their axis, are tried at every value of
the parameter, the double wishbone at every fourth, all others at one: what is hard about a value is the same
in each. Values are few: far from the singular place, at it, between them, and where `right` begins to be
demanded.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

from validate.hard.answer import Answer, Outcome
from validate.hard.subjects import BESIDE, PAPER, SUBJECTS, WISHBONE, Content, Subject, hyphens
from validate.hard.trial import OURS, Trial, try_scene

# Every case that pointcoord has to solve is tried by a map of the inputs too.
MAP = "pointcoord-map"
SOLVERS = (OURS, "pointcoord-newton", "absolute", "relative")
# Why a model may refuse a mechanism, or no reference be had of it.
HARD: Mapping[str, str] = {"bricard": "one of its rows depends on the others at every pose"}
SceneAt = Callable[[Subject, float], Content]
Values = Sequence[float]


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


RIGHT = Expected(("right",))
RIGHT_OR_REFUSED = Expected(("right", "refused"))
REFUSED = Expected(("refused",))
# Of mechanisms that a model may refuse, and of which there may be no reference: then nothing is judged.
IF_ANY = Expected(("right", "refused", "unjudged"))
FAILS = Expected(("refused", "noted", "wrong"))


@dataclass(frozen=True, kw_only=True)
class Case:
    """One row of the catalogue.

    Attributes:
        name: on the command line, words joined by hyphens.
        group: heading that it is shown under.
        why: one sentence that says why it is hard.
        parameter: what tends to the singular place, with its unit.
        values: of the parameter, evenly spaced in its logarithm.
        scene: the content of the scene, of a mechanism and at a value.
        subject: the mechanism.
        expected: by formulation; a case tries the formulations named here.
        judged: the trial at a value, with what else is measured, or asked of its answers.
        unit: of error and bound.
        given: whether the scene can be given to another solver.
        beyond: whether the scene has no pose at some instants, and `right` is a refusal that says so rightly.
        also_answered: values at which the scene has an answer although `expected` allows a refusal as well;
            they need not be among those that are tried.
    """

    name: str
    group: str
    why: str
    parameter: str
    values: tuple[float, ...]
    scene: SceneAt
    subject: Subject
    expected: Mapping[str, Expected]
    judged: Callable[[Subject, float, Trial], Trial] | None = None
    unit: str = "mm"
    given: bool = True
    beyond: bool = False
    also_answered: tuple[float, ...] = ()

    def content(self, value: float) -> Content:
        """Of the scene at a value."""
        return self.scene(self.subject, value)

    def examine(self, value: float) -> Trial:
        """Try one value."""
        trial = try_scene(value, self.content(value), tuple(self.expected))
        return trial if self.judged is None else self.judged(self.subject, value, trial)

    def without(self, formulations: Collection[str]) -> Case:
        """The same, tried by none of some formulations, such as those that are not installed."""
        left = {name: one for name, one in self.expected.items() if name not in formulations}
        return replace(self, expected=left)

    @property
    def mapped(self) -> tuple[float, ...]:
        """The values that are tried by a map too: the one amid them and the last, as each takes long."""
        by_map = OURS in self.expected and MAP not in self.expected
        return (self.values[len(self.values) // 2], self.values[-1]) if by_map else ()

    def allowed(self, formulation: str) -> Expected:
        """What a formulation may come to.

        A map may be refused, its effort being bounded; it answers only where the other method may.
        """
        if formulation == MAP and MAP not in self.expected:
            return RIGHT_OR_REFUSED if "right" in self.expected[OURS].outcomes else REFUSED
        return self.expected[formulation]

    def unexpected(self, trial: Trial) -> tuple[Answer, ...]:
        """The answers of a trial that are not allowed."""
        return tuple(a for a in trial.answers if not self.allowed(a.formulation).met(trial.value, a.outcome))

    @property
    def behaviour(self) -> str:
        """What is expected, in words: formulations of which as much is expected are named together."""
        alike: dict[str, list[str]] = {}
        for name, one in self.expected.items():
            alike.setdefault(one.words, []).append(name)
        if len(alike) == 1:
            return next(iter(alike))
        return "; ".join(f"{', '.join(names)}: {words}" for words, names in alike.items())

    @property
    def without_pose(self) -> bool:
        """Whether some instants of a scene that is given to others have no pose, at every value."""
        return self.given and (self.beyond or all(one == REFUSED for one in self.expected.values()))

    @property
    def answered(self) -> tuple[float, ...]:
        """The values at which the scene has an answer that any solver can be asked for."""
        if not self.given or self.without_pose:
            return ()
        expected = self.expected.get(OURS) or next(iter(self.expected.values()))
        needed = (v for v in self.values if expected.met(v, "right") and not expected.met(v, "refused"))
        return tuple(dict.fromkeys((*needed, *self.also_answered)))


def case(
    scene: SceneAt,
    parameter: str,
    values: Values,
    expected: Expected | Mapping[str, Expected] = RIGHT,
    subject: Subject = PAPER,
    *,
    name: str = "",
    why: str = "",
    suffix: str | None = None,
    **more: Any,
) -> Case:
    """A case, see `Case`.

    Args:
        expected: by formulation, or of each of `SOLVERS`.
        name, why: the scene's own name, and the first paragraph of its text, if not given.
        suffix: of the name; that of the mechanism if not given.
    """
    return Case(
        name=(name or hyphens(whole(scene).__name__)) + (subject.suffix if suffix is None else suffix),
        why=why or reason_of(scene),
        parameter=parameter,
        values=tuple(values),
        scene=scene,
        subject=subject,
        expected=dict.fromkeys(SOLVERS, expected) if isinstance(expected, Expected) else expected,
        **more,
    )


def whole(function: Callable[..., Any]) -> Callable[..., Any]:
    """The function of which this one is a part with some arguments given."""
    return whole(function.func) if isinstance(function, partial) else function


def reason_of(function: Callable[..., Any]) -> str:
    """Why a case is hard that a function makes: the first paragraph of its text."""
    return " ".join((whole(function).__doc__ or "").partition("\n\n")[0].split())


def family(
    scene: SceneAt,
    parameter: str,
    values: Values | Callable[[Subject], Values],
    expected: Expected | Mapping[str, Expected] = RIGHT,
    subjects: Sequence[Subject] = SUBJECTS,
    **more: Any,
) -> tuple[Case, ...]:
    """A case for each of some mechanisms; see `case`. Of those that are hard by nature less is expected.

    Args:
        values: that the first mechanism is tried at, or of each.
    """
    return tuple(
        case(
            scene,
            parameter,
            values(one) if callable(values) else values_of(one, values),
            expected_of(one, expected),
            one,
            **more,
        )
        for one in subjects
    )


def expected_of(
    subject: Subject, expected: Expected | Mapping[str, Expected]
) -> Expected | Mapping[str, Expected]:
    """What formulations may make of a mechanism; of one that is hard by nature, never wrong numbers."""
    if subject.name not in HARD:
        return expected
    return IF_ANY if isinstance(expected, Expected) else dict.fromkeys(expected, IF_ANY)


def values_of(subject: Subject, values: Values) -> Values:
    """Those of a family's values that a mechanism is tried at: all, every fourth and the last, or one."""
    if subject in (PAPER, BESIDE):
        return values
    return coarse(values) if subject is WISHBONE else (values[len(values) // 2],)


def decades(low: int = -12, high: int = 0) -> tuple[float, ...]:
    """Every third decade, going in: from 10^high down to 10^low, both among them."""
    return tuple(float(f"1e{k}") for k in (*range(high, low, -3), low))


def coarse(values: Values) -> tuple[float, ...]:
    """Every fourth value and the last."""
    return tuple(dict.fromkeys((*values[::4], values[-1])))


def counted(count: int) -> tuple[float, ...]:
    """Numbers from 1 to a count, as values of a parameter."""
    return tuple(float(n) for n in range(1, count + 1))
