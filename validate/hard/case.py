"""A hard case is a row: why it is hard, a scene made from one number that leads into it, what has to come.

A family is such a row for every mechanism. The paper's strut is tried at every value of the number, the
others at one: what is hard about a value is the same in each. Values are few: far from the singular place, at
it, between them, and where `right` has to begin.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

from validate.formulations.protocol import Solution
from validate.hard.answer import MAP, NOT_ASKED, OURS, Answer, Outcome, Trial, try_scene
from validate.hard.subjects import PAPER, SUBJECTS, Content, Subject, hyphens
from validate.reference import InfeasibleError

SOLVERS = (OURS, "pointcoord-newton", "absolute", "relative")
# Why a model may refuse a mechanism, or no reference be had of it.
HARD: Mapping[str, str] = {"bricard": "one of its rows depends on the others at every pose"}
SceneAt = Callable[[Subject, float], Content]
Judge = Callable[[Subject, float, Trial, Answer], Answer]
Facts = Callable[[Subject, float], Mapping[str, float | str]]
Values = Sequence[float]
Every = Callable[[Subject], Values]


@dataclass(frozen=True)
class Expected:
    """What a formulation may make of a case.

    Attributes:
        outcomes: those allowed.
        right_from: for values of the parameter from here up only `right` is allowed.
    """

    outcomes: tuple[Outcome, ...]
    right_from: float = float("inf")

    @property
    def words(self) -> str:
        """In words."""
        surely = f"; right from {self.right_from:g} up" if self.right_from < float("inf") else ""
        return " or ".join(self.outcomes) + surely

    def met(self, value: float, outcome: Outcome) -> bool:
        """Whether an outcome is what had to come."""
        return outcome in (("right",) if value >= self.right_from else self.outcomes)


RIGHT = Expected(("right",))
RIGHT_OR_REFUSED = Expected(("right", "refused"))
REFUSED = Expected(("refused",))
# Of mechanisms that a model may refuse, and of which there may be no reference: then nothing is judged.
IF_ANY = Expected(("right", "refused", "unjudged"))


def right_from(least: float) -> Expected:
    """Right, or refused at less than a value."""
    return replace(RIGHT_OR_REFUSED, right_from=least)


@dataclass(frozen=True, kw_only=True)
class Case:
    """One row of the catalogue.

    Attributes:
        name: on the command line, words joined by hyphens.
        group: heading that it is shown under.
        why: one sentence that says why it is hard.
        parameter: what tends to the singular place, with its unit.
        values: of the parameter.
        scene: the content of the scene, of a mechanism and at a value.
        subject: the mechanism.
        expected: by formulation; a case tries the formulations named here.
        judge: what becomes of an answer by what else is asked of it here.
        facts: that say more of a value, by name with its unit.
        unit: of error and bound.
        given: whether the scene can be given to another solver.
        beyond: whether the scene has no pose at some instants, and `right` is a refusal that says so rightly.
    """

    name: str
    group: str
    why: str
    parameter: str
    values: tuple[float, ...]
    scene: SceneAt
    subject: Subject
    expected: Mapping[str, Expected]
    judge: Judge | None = None
    facts: Facts | None = None
    unit: str = "mm"
    given: bool = True
    beyond: bool = False

    def content(self, value: float) -> Content:
        """Of the scene at a value."""
        return self.scene(self.subject, value)

    def examine(self, value: float) -> Trial:
        """Try one value; by a map as well if it is one of the few, where there is something to compare."""
        by_map = [MAP] if value in self.mapped else []
        trial = try_scene(value, self.content(value), [*self.expected, *by_map])
        answers, of_map = trial.answers[: len(self.expected)], trial.answers[len(self.expected) :]
        if (judge := self.judge) is not None:
            answers = tuple(judge(self.subject, value, trial, answer) for answer in answers)
        comparable = isinstance(trial.reference, Solution | InfeasibleError) or trial.reference is NOT_ASKED
        if trial.scene is not None and comparable:
            answers += of_map
        facts = self.facts(self.subject, value) if self.facts else {}
        return replace(trial, answers=answers, facts={**trial.facts, **facts})

    def without(self, formulations: Collection[str]) -> Case:
        """The same, tried by none of some formulations, such as those that are not installed."""
        left = {name: one for name, one in self.expected.items() if name not in formulations}
        return replace(self, expected=left)

    @property
    def mapped(self) -> tuple[float, ...]:
        """The values that are tried by a map too: the one amid them and the last, as each takes long.

        A map says nothing of how far it came, so that none is asked for what lies beyond the last pose.
        """
        by_map = OURS in self.expected and MAP not in self.expected and not self.beyond
        return (self.values[len(self.values) // 2], self.values[-1]) if by_map else ()

    def unexpected(self, trial: Trial) -> tuple[Answer, ...]:
        """The answers of a trial that are not allowed.

        A map may be refused, its effort being bounded; it answers only where the other method may.
        """
        allowed = dict(self.expected)
        if OURS in allowed:
            of_map = RIGHT_OR_REFUSED if "right" in allowed[OURS].outcomes else REFUSED
            allowed.setdefault(MAP, of_map)
        return tuple(a for a in trial.answers if not allowed[a.formulation].met(trial.value, a.outcome))

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
        return tuple(v for v in self.values if expected.met(v, "right") and not expected.met(v, "refused"))


def family(
    cases: list[Case],
    group: str,
    parameter: str,
    values: Values | Every,
    expected: Expected | Mapping[str, Expected] | Callable[[Subject], Expected] = RIGHT,
    subjects: Sequence[Subject] = SUBJECTS,
    *,
    name: str = "",
    why: str = "",
    suffix: str | None = None,
    given: bool = True,
    **more: Any,
) -> Callable[[SceneAt], SceneAt]:
    """Put the cases that a scene makes of some mechanisms at the end of some others, see `Case`.

    Those that are hard by nature are given to nobody.

    Args:
        values: all that a single mechanism or the strut is tried at, the others at one of them; or of each.
        expected: by formulation, or of each of `SOLVERS`, of any mechanism or each.
        name, why: the scene's own name, and the first paragraph of its text, if not given.
        suffix: of the name; that of the mechanism if not given.
    """

    def rows(scene: SceneAt) -> SceneAt:
        made: Any = scene.func if isinstance(scene, partial) else scene
        for one in subjects:
            which = expected(one) if callable(expected) else expected
            each = dict.fromkeys(SOLVERS, which) if isinstance(which, Expected) else which
            refusable = set(each.values()) <= {REFUSED, RIGHT_OR_REFUSED}
            if callable(values):
                tried = values(one)
            else:
                tried = values_of(one, values) if len(subjects) > 1 else values
            case = Case(
                name=(name or hyphens(made.__name__)) + (one.suffix if suffix is None else suffix),
                group=group,
                why=why or reason_of(made),
                parameter=parameter,
                values=tuple(tried),
                scene=scene,
                subject=one,
                expected=each,
                given=given and (refusable or one.name not in HARD),
                **more,
            )
            cases.append(case)
        return scene

    return rows


def reason_of(function: Callable[..., Any]) -> str:
    """Why a case is hard that a function makes: the first paragraph of its text."""
    return " ".join((function.__doc__ or "").partition("\n\n")[0].split())


def values_of(subject: Subject, values: Values) -> Values:
    """Those of a family's values that a mechanism is tried at: all, or the one amid them."""
    return values if subject is PAPER else (values[len(values) // 2],)


def decades(low: int = -12, high: int = 0) -> tuple[float, ...]:
    """Every third decade, going in: from 10^high down to 10^low, both among them."""
    return tuple(float(f"1e{k}") for k in (*range(high, low, -3), low))


def every(found: Callable[[Subject], Sequence[object]], step: int = 1) -> Every:
    """A number, from 1, for each thing that a mechanism has; of all but the strut for one amid them.

    Args:
        step: of the strut's things one of so many.
    """

    def values(subject: Subject) -> Values:
        numbers = tuple(float(n) for n in range(1, len(found(subject)) + 1))
        return numbers[::step] if subject is PAPER else values_of(subject, numbers)

    return values
