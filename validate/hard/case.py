"""A hard case: why it is hard, a function that makes its scene from one number, and the expected outcome.

A family is such a case for every mechanism. The paper's strut is run at every value of the number, the other
mechanisms at one, since the difficulty is the same in each. The values are few: far from the singular pose,
at it, between them, and the value from which an answer must be right.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

from pointcoord import MissingLibrary
from validate.formulations.protocol import Solution
from validate.hard.answer import MAP, NOT_ASKED, OURS, Answer, Outcome, Trial, try_scene
from validate.hard.subjects import PAPER, SUBJECTS, Content, Subject, hyphens
from validate.plain_text import named
from validate.reference import InfeasibleError

SOLVERS = (OURS, "pointcoord-newton", "absolute", "relative")
# Mechanisms that a model may refuse, or for which the reference may find no proof, with the reason.
HARD: Mapping[str, str] = {"bricard": "one of its rows depends on the others at every pose"}
SceneAt = Callable[[Subject, float], Content]
Judge = Callable[[Subject, float, Trial, Answer], Answer]
Facts = Callable[[Subject, float], Mapping[str, float | str]]
Values = Sequence[float]
Every = Callable[[Subject], Values]


@dataclass(frozen=True)
class Expected:
    """The outcomes of a formulation that a case allows.

    Attributes:
        outcomes: the allowed outcomes.
        right_from: at values of the parameter from here up only `right` is allowed.
    """

    outcomes: tuple[Outcome, ...]
    right_from: float = float("inf")

    @property
    def words(self) -> str:
        """The allowed outcomes in words."""
        surely = f"; right from {self.right_from:g} up" if self.right_from < float("inf") else ""
        return " or ".join(self.outcomes) + surely

    def met(self, value: float, outcome: Outcome) -> bool:
        """Whether an outcome is allowed at a value."""
        return outcome in (("right",) if value >= self.right_from else self.outcomes)


RIGHT = Expected(("right",))
RIGHT_OR_REFUSED = Expected(("right", "refused"))
REFUSED = Expected(("refused",))
# For mechanisms that a model may refuse, and for which there may be no reference, so that nothing is judged.
IF_ANY = Expected(("right", "refused", "unjudged"))


def right_from(least: float) -> Expected:
    """Right or refused below a value, right from this value up."""
    return replace(RIGHT_OR_REFUSED, right_from=least)


@dataclass(frozen=True, kw_only=True)
class Case:
    """One row of the catalogue.

    Attributes:
        name: on the command line, words joined by hyphens.
        group: the heading in listings.
        why: one sentence on why it is hard.
        parameter: what is varied towards the singular pose, with its unit.
        values: values of the parameter.
        scene: makes the content of the scene from the mechanism and a value.
        subject: the mechanism.
        expected: the allowed outcomes by formulation; these formulations are run.
        judge: a further check of an answer; returns the answer, with its outcome corrected.
        facts: returns further facts on a value, by name with unit.
        unit: unit of error and bound.
        given: whether the scene may be given to another solver, too.
        beyond: whether the scene has no pose at some instants; `right` is then a correct refusal.
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
        """The content of the scene at a value."""
        return self.scene(self.subject, value)

    def examine(self, value: float) -> Trial:
        """Solve the case at one value; at the values of `mapped` by a map too, if it can be compared.

        An error of the trial itself makes all its answers unjudged; the run continues.

        Raises:
            MissingLibrary: a formulation of the case is not installed.
        """
        try:
            by_map = [MAP] if value in self.mapped else []
            trial = try_scene(value, self.content(value), [*self.expected, *by_map])
            answers, of_map = trial.answers[: len(self.expected)], trial.answers[len(self.expected) :]
            if (judge := self.judge) is not None:
                answers = tuple(judge(self.subject, value, trial, answer) for answer in answers)
            known = trial.reference is NOT_ASKED or isinstance(trial.reference, Solution | InfeasibleError)
            if trial.scene is not None and known:
                answers += of_map
            facts = self.facts(self.subject, value) if self.facts else {}
            return replace(trial, answers=answers, facts={**trial.facts, **facts})
        except MissingLibrary:
            raise
        except Exception as error:
            reason = f"the trial fails: {named(error)}"
            return Trial(value, tuple(Answer(name, "unjudged", reason) for name in self.expected))

    def without(self, formulations: Collection[str]) -> Case:
        """This case without some formulations, such as those that are not installed."""
        left = {name: one for name, one in self.expected.items() if name not in formulations}
        return replace(self, expected=left)

    @property
    def mapped(self) -> tuple[float, ...]:
        """The values that are solved by a map too: the middle one and the last, because each takes long.

        A refusal by a map does not say how far it came, so none is made for cases beyond the last pose.
        """
        by_map = OURS in self.expected and MAP not in self.expected and not self.beyond
        return (self.values[len(self.values) // 2], self.values[-1]) if by_map else ()

    def unexpected(self, trial: Trial) -> tuple[Answer, ...]:
        """The answers of a trial that are not allowed.

        A map may always be refused, since its effort is limited; it may answer only if pointcoord may.
        """
        allowed = dict(self.expected)
        if OURS in allowed:
            of_map = RIGHT_OR_REFUSED if "right" in allowed[OURS].outcomes else REFUSED
            allowed.setdefault(MAP, of_map)
        return tuple(a for a in trial.answers if not allowed[a.formulation].met(trial.value, a.outcome))

    @property
    def behaviour(self) -> str:
        """The allowed outcomes in words; formulations with equal ones are named together."""
        alike: dict[str, list[str]] = {}
        for name, one in self.expected.items():
            alike.setdefault(one.words, []).append(name)
        if len(alike) == 1:
            return next(iter(alike))
        return "; ".join(f"{', '.join(names)}: {words}" for words, names in alike.items())

    @property
    def without_pose(self) -> bool:
        """Whether other solvers can be given the scene, and it has instants without a pose at every value."""
        return self.given and (self.beyond or all(one == REFUSED for one in self.expected.values()))

    @property
    def answered(self) -> tuple[float, ...]:
        """The values at which any solver should be able to answer."""
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
    """A decorator of a scene function: appends its case for each mechanism to `cases`, see `Case`.

    Mechanisms in `HARD` are not given to other solvers.

    Args:
        values: the values for a single mechanism or for the paper's strut, other mechanisms get the middle
            one; or a function that returns the values for a mechanism.
        expected: by formulation, or for all `SOLVERS`; or a function that returns it for a mechanism.
        name, why: the function's name, and the first paragraph of its docstring, if not given.
        suffix: suffix of the name; the suffix of the mechanism if not given.
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
    """Why a case is hard: the first paragraph of its function's docstring."""
    return " ".join((function.__doc__ or "").partition("\n\n")[0].split())


def values_of(subject: Subject, values: Values) -> Values:
    """The values of a family for a mechanism: all for the paper's strut, the middle one for others."""
    return values if subject is PAPER else (values[len(values) // 2],)


def decades(low: int = -12, high: int = 0) -> tuple[float, ...]:
    """Every third decade from 10^high down to 10^low, both included."""
    return tuple(float(f"1e{k}") for k in (*range(high, low, -3), low))


def every(found: Callable[[Subject], Sequence[object]], step: int = 1) -> Every:
    """The numbers, from 1, of all parts that `found` lists; for mechanisms other than the strut the middle
    one.

    Args:
        step: every `step`-th part of the strut.
    """

    def values(subject: Subject) -> Values:
        numbers = tuple(float(n) for n in range(1, len(found(subject)) + 1))
        return numbers[::step] if subject is PAPER else values_of(subject, numbers)

    return values
