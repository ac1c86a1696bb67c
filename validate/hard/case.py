"""A hard case is a row: a mechanism, a function that makes its scene from one number, the expected outcome.

A family is such a row for every mechanism. The paper's strut is run at every value of the number, the other
mechanisms at one, since the difficulty is the same in each. The values are few: far from the singular pose,
at it, between them, and the value from which an answer must be right.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from pointcoord import MissingLibrary
from validate.hard.answer import MAP, OURS, Answer, Outcome, Trial, try_scene
from validate.hard.subjects import PAPER, SUBJECTS, Content, Subject, hyphens
from validate.plain_text import gathered, named

SOLVERS = (OURS, "pointcoord-newton", "absolute", "relative")
# Mechanisms that a model may refuse, or for which the reference may find no proof, with the reason.
HARD: Mapping[str, str] = {"bricard": "one of its rows depends on the others at every pose"}


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

    def at(self, value: float) -> tuple[Outcome, ...]:
        """The allowed outcomes at a value."""
        return ("right",) if value >= self.right_from else self.outcomes


RIGHT = Expected(("right",))
RIGHT_OR_REFUSED = Expected(("right", "refused"))
REFUSED = Expected(("refused",))
# For mechanisms that a model may refuse, and for which there may be no reference, so that nothing is judged.
IF_ANY = Expected(("right", "refused", "unjudged"))


def right_from(least: float) -> Expected:
    """Right or refused below a value, right from this value up."""
    return replace(RIGHT_OR_REFUSED, right_from=least)


@dataclass(frozen=True)
class Setup:
    """The scene of a case at one value, if there is more to say about it than its content.

    Attributes:
        content: the content of the scene.
        facts: what the value stands for, by name with unit.
        judge: a further check of an answer; returns the answer, with its outcome corrected.
    """

    content: Content
    facts: Mapping[str, float | str] = field(default_factory=dict)
    judge: Callable[[Trial, Answer], Answer] = lambda trial, answer: answer


SceneAt = Callable[[Subject, float], Content | Setup]
Values = Sequence[float] | Callable[[Subject], Sequence[float]]


@dataclass(frozen=True, kw_only=True)
class Case:
    """One row of the catalogue.

    Attributes:
        name: on the command line, words joined by hyphens.
        group: the heading in listings.
        why: one sentence on why it is hard.
        parameter: what is varied towards the singular pose, with its unit.
        values: values of the parameter.
        scene: makes the scene from the mechanism and a value.
        subject: the mechanism.
        expected: the allowed outcomes by formulation; these formulations are run.
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
    unit: str = "mm"
    given: bool = True
    beyond: bool = False

    def at(self, value: float) -> Setup:
        """The scene at a value, with its facts and judge."""
        made = self.scene(self.subject, value)
        return made if isinstance(made, Setup) else Setup(made)

    def content(self, value: float) -> Content:
        """The content of the scene at a value."""
        return self.at(value).content

    def examine(self, value: float) -> Trial:
        """Solve the case at one value; at the values of `mapped` by a map too, if it can be compared.

        An error of the trial itself makes all its answers unjudged; the run continues.

        Raises:
            MissingLibrary: a formulation of the case is not installed.
        """
        try:
            setup, by_map = self.at(value), [MAP] if value in self.mapped else []
            trial = try_scene(value, setup.content, [*self.expected, *by_map])
            own, of_map = trial.answers[: len(self.expected)], trial.answers[len(self.expected) :]
            if trial.scene is None or any(answer.outcome == "unjudged" for answer in own):
                of_map = ()
            answers = (*(setup.judge(trial, answer) for answer in own), *of_map)
            return replace(trial, answers=answers, facts={**trial.facts, **setup.facts})
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
        by_map = OURS in self.expected and not self.beyond
        return (self.values[len(self.values) // 2], self.values[-1]) if by_map else ()

    def unexpected(self, trial: Trial) -> tuple[Answer, ...]:
        """The answers of a trial that are not allowed.

        A map may always be refused, since its effort is limited; it may answer only if pointcoord may.
        """
        of_map = RIGHT_OR_REFUSED if "right" in self.expected.get(OURS, REFUSED).outcomes else REFUSED
        allowed = {MAP: of_map, **self.expected}
        return tuple(a for a in trial.answers if a.outcome not in allowed[a.formulation].at(trial.value))

    @property
    def behaviour(self) -> str:
        """The allowed outcomes in words; formulations with equal ones are named together."""
        alike = gathered((one.words, name) for name, one in self.expected.items())
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
        return tuple(value for value in self.values if expected.at(value) == ("right",))


def family(
    cases: list[Case],
    group: str,
    parameter: str,
    values: Values,
    expected: Expected | Mapping[str, Expected] | Callable[[Subject], Expected] = RIGHT,
    subjects: Sequence[Subject] = SUBJECTS,
    *,
    name: str = "",
    why: str = "",
    step: int = 1,
    given: bool = True,
    **more: Any,
) -> Callable[[SceneAt], SceneAt]:
    """A decorator of a scene function: appends its case for each mechanism to `cases`, see `Case`.

    Mechanisms in `HARD` are not given to other solvers.

    Args:
        values: the values for a single mechanism or for the paper's strut; or a function that returns the
            values for a mechanism. Other mechanisms get the middle one.
        expected: by formulation, or for all `SOLVERS`; or a function that returns it for a mechanism.
        name, why: the function's name, and the first paragraph of its docstring, if not given.
        step: only every `step`-th value of the strut is run.
    """

    def rows(scene: SceneAt) -> SceneAt:
        for one in subjects:
            which = expected(one) if callable(expected) else expected
            each = dict.fromkeys(SOLVERS, which) if isinstance(which, Expected) else which
            refusable = set(each.values()) <= {REFUSED, RIGHT_OR_REFUSED}
            found, alone = (values(one), False) if callable(values) else (values, len(subjects) == 1)
            middle = len(found) // 2
            case = Case(
                name=(name or hyphens(scene.__name__)) + one.suffix,
                group=group,
                why=why or " ".join((scene.__doc__ or "").partition("\n\n")[0].split()),
                parameter=parameter,
                values=tuple(found[::step] if alone or one is PAPER else found[middle : middle + 1]),
                scene=scene,
                subject=one,
                expected=each,
                given=given and (refusable or one.name not in HARD),
                **more,
            )
            cases.append(case)
        return scene

    return rows


def decades(low: int = -12, high: int = 0) -> tuple[float, ...]:
    """Every third decade from 10^high down to 10^low, both included."""
    return tuple(float(f"1e{k}") for k in (*range(high, low, -3), low))


def numbers_of(found: Callable[[Subject], Sequence[object]]) -> Callable[[Subject], Sequence[float]]:
    """For a mechanism, the numbers from 1 of all parts that `found` lists."""
    return lambda subject: [float(n) for n in range(1, len(found(subject)) + 1)]
