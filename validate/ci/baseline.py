r"""Baselines: the solved numbers of a run with what was claimed of them, and what moved since.

A number that was x0 and is x now, with claimed errors e0 and e, was right both times only if

    |x - x0| <= e0 + e + eps^2 M        (see `comparison.tolerance`).

Beyond that bound it has moved: one of the claims is broken. Below it both may be right, and bits may differ.

The file is an npz: `format`, `version`, and `head`, a text of JSON, beside arrays `a0`, `a1`, ...; nothing in
it runs when it is read. The head has `program`, the version that wrote it, and `scenes`. Each of these has
`scene`, the name that it was run under; `mechanism`, the car's type, axes and points; `motion`, a SHA-256 of
its inputs and time; and `solutions`. Each of these has `formulation`, and the numbers of its arrays: of
`times` (s) and `condition`, (N,), and by quantity and name of the `numbers`, (N, 3) or (N,), in the units of
pointcoord's quantities, and of the `claims` about them.
"""

from __future__ import annotations

import hashlib
import io
import json
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from pointcoord import Scene
from pointcoord.effects.registry import QUANTITIES
from validate.comparison.compare import Comparison, Outcome, compare_solutions
from validate.comparison.given import given, usable
from validate.errors import UsageError
from validate.exit_status import ExitStatus
from validate.formulations.protocol import Accuracy, Solution
from validate.output.document import program_version
from validate.plain_text import shown

Array = NDArray[np.float64]

FORMAT, VERSION = "pointcoord baseline", 1
ALLOWED = "a file that --save-baseline wrote"
NEVER = np.empty(0)  # the instants at which a run gives what it does not give

Standing = Literal["compared", "new", "not solved now", "another car", "another motion"]
MoveVerdict = Literal["agrees", "moved", "not tested", "new", "gone"]


@dataclass(frozen=True)
class Move:
    """How far one quantity of one point, body or angle moved since the baseline.

    Attributes:
        row: the formulation's numbers then compared with its numbers now: the difference is the movement, the
            tolerance what both claims allow; NaN of what only one of the two runs has.
        verdict: `moved` beyond that; `new` is not in the baseline and `gone` no longer given.
    """

    row: Comparison
    verdict: MoveVerdict

    @property
    def formulation(self) -> str:
        """Whose numbers they are."""
        return self.row.first


@dataclass(frozen=True)
class Since:
    """A scene against the baseline.

    Attributes:
        standing: whether it could be compared, and why not.
        words: more of that, such as what of the car is another, or that a formulation is.
        replaced: whether the run has another formulation in the place of one of the baseline's. Under another
            name it may be another solver: whether its numbers moved cannot be said.
    """

    scene: str
    standing: Standing
    words: str = ""
    moves: tuple[Move, ...] = ()
    replaced: bool = False

    @property
    def compared(self) -> bool:
        """Whether any number could be held to the baseline."""
        return any(move.verdict not in ("new", "gone") for move in self.moves)

    @property
    def moved(self) -> tuple[Move, ...]:
        """What moved beyond what both claims allow."""
        return tuple(move for move in self.moves if move.verdict == "moved")

    @property
    def lost(self) -> tuple[Move, ...]:
        """What a formulation gave then that is in this run too, and does not give now."""
        here = {move.formulation for move in self.moves if move.verdict != "gone"}
        return tuple(move for move in self.moves if move.verdict == "gone" and move.formulation in here)

    @property
    def status(self) -> ExitStatus:
        """What the scene's movement alone would end the run with.

        A scene that is new or that is refused now says nothing of movement; the latter is told of anyway. So
        are the numbers of a formulation that this run does not ask, unless it asks another one in its place.
        """
        if self.moved or self.lost:
            return ExitStatus.DISAGREE
        if self.standing in ("new", "not solved now"):
            return ExitStatus.AGREE
        untested = any(move.verdict == "not tested" for move in self.moves)
        return (
            ExitStatus.AGREE
            if self.compared and not untested and not self.replaced
            else ExitStatus.NO_VERDICT
        )


@dataclass(frozen=True)
class SavedScene:
    """A scene as a baseline has it; see the file's description."""

    mechanism: Mapping[str, Any]
    motion: str
    solutions: tuple[Solution, ...]


@dataclass(frozen=True)
class Baseline:
    """What a run solved once.

    Attributes:
        target: the file. program: version of the program that wrote it. scenes: by name.
    """

    target: str
    program: str
    scenes: Mapping[str, SavedScene]

    def since(self, name: str, scene: Scene, outcomes: Sequence[Outcome], factor: float = 1.0) -> Since:
        """What of a scene moved.

        Args:
            outcomes: all that the scene was compared in now. factor: how many times the bound is allowed.
        """
        then = self.scenes.get(name)
        if then is None:
            return Since(name, "new", f"{name} is not in the baseline")
        if other := ", ".join(_differing(then.mechanism, _mechanism(scene))):
            return Since(name, "another car", f"{name} is another car than in the baseline: {other}")
        if _motion(scene) != then.motion:
            words = f"{name} has other inputs or another time than in the baseline"
            return Since(name, "another motion", words)
        if not outcomes:
            return Since(name, "not solved now", f"{name} is in the baseline and has no comparison now")
        moves = tuple(_moves(name, scene, then.solutions, outcomes, factor))
        before = {solution.formulation for solution in then.solutions}
        now = {solution.formulation for outcome in outcomes for solution in outcome.solutions}
        lacking, others = (", ".join(sorted(some)) for some in (before - now, now - before))
        if not lacking or not others:
            return Since(name, "compared", "", moves)
        words = (
            f"{name} has another formulation than in the baseline: {others} in the place of {lacking}, of "
            "which no number could be compared with it"
        )
        return Since(name, "compared", words, moves, replaced=True)


def baseline_data(baseline: Baseline, found: Sequence[Since], gone: Sequence[str]) -> dict[str, Any]:
    """A run against its baseline as plain data."""
    return {
        "file": baseline.target,
        "program": baseline.program,
        "scenes": [
            {
                "scene": since.scene,
                "standing": since.standing,
                "words": since.words,
                "exit_status": since.status.value,
                "moves": [
                    {key: getattr(move.row, key) for key in ("quantity", "name", "unit", "share", "instant")}
                    | {"formulation": move.formulation, "verdict": move.verdict}
                    | {"moved": move.row.difference, "bound": move.row.tolerance}
                    for move in since.moves
                ],
            }
            for since in found
        ],
        "gone": list(gone),
    }


def _moves(
    name: str, scene: Scene, then: Sequence[Solution], outcomes: Sequence[Outcome], factor: float
) -> Iterator[Move]:
    before, now = ({one.formulation: one for one in some} for some in (then, solutions_of(scene, outcomes)))
    for formulation in dict.fromkeys((*now, *before)):
        # A run that has no such formulation has no number of it.
        nothing = Solution(formulation, NEVER, {}, Accuracy(NEVER))
        one, two = before.get(formulation, nothing), now.get(formulation, nothing)
        asked = {q: tuple({**one.numbers.get(q, {}), **two.numbers.get(q, {})}) for q in QUANTITIES}
        for row in compare_solutions(scene, one, two, name, asked, factor).rows:
            yield Move(row, _verdict(row, one))


def _verdict(row: Comparison, then: Solution) -> MoveVerdict:
    if row.verdict == "not given":
        return "gone" if row.name in then.numbers.get(row.quantity, ()) else "new"
    return "moved" if row.verdict == "disagrees" else row.verdict


def solutions_of(scene: Scene, outcomes: Iterable[Outcome]) -> tuple[Solution, ...]:
    """Each formulation's solution once, as a comparison takes it."""
    found: dict[str, Solution] = {}
    for solution in (solution for outcome in outcomes for solution in outcome.solutions):
        if solution.formulation not in found:
            found[solution.formulation] = usable(solution, scene.instants)
    return tuple(found.values())


def _mechanism(scene: Scene) -> dict[str, Any]:
    """The car as plain data: everything of it that is solved for."""
    return dict(scene.mechanism.model_dump(mode="json"))


def _motion(scene: Scene) -> str:
    """A digest of what drives the car, and when."""
    content = scene.model_dump(mode="json", include={"inputs", "time"})
    return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()


def _differing(then: Mapping[str, Any], now: Mapping[str, Any]) -> Iterator[str]:
    """The keys of a car that are other ones, and of its points those that are."""
    for key in sorted(then.keys() | now.keys()):
        before, after = then.get(key), now.get(key)
        if isinstance(before, Mapping) and isinstance(after, Mapping):
            yield from (n for n in sorted(before.keys() | after.keys()) if before.get(n) != after.get(n))
        elif before != after:
            yield key


class Recorder:
    """Gathers scenes for a baseline; one of 100 instants takes half a megabyte."""

    def __init__(self) -> None:
        self._scenes: dict[str, dict[str, Any]] = {}
        self._arrays: list[Array] = []

    def __len__(self) -> int:
        return len(self._scenes)

    def add(self, name: str, scene: Scene, outcomes: Sequence[Outcome]) -> None:
        """Take in a scene that was compared; one that was not has no numbers to keep."""
        if not outcomes or name in self._scenes:
            return
        solutions = [
            {
                "formulation": solution.formulation,
                "times": solution.times,
                "condition": solution.accuracy.condition,
                "numbers": solution.numbers,
                "claims": solution.accuracy.claims,
            }
            for solution in solutions_of(scene, outcomes)
        ]
        known = {"scene": name, "mechanism": _mechanism(scene), "motion": _motion(scene)}
        self._scenes[name] = {**known, "solutions": [self._numbered(one) for one in solutions]}

    def _numbered(self, content: Any) -> Any:
        """The same with the number of each array in its place."""
        if isinstance(content, Mapping):
            return {key: self._numbered(value) for key, value in content.items()}
        if not isinstance(content, np.ndarray):
            return content
        self._arrays.append(content)
        return len(self._arrays) - 1

    def content(self) -> bytes:
        """The file of a baseline."""
        head = {"program": program_version(), "scenes": list(self._scenes.values())}
        arrays: dict[str, Any] = {f"a{i}": array for i, array in enumerate(self._arrays)}
        arrays |= {"format": FORMAT, "version": VERSION, "head": json.dumps(head)}
        stream = io.BytesIO()
        np.savez_compressed(stream, **arrays)
        return stream.getvalue()


def read_baseline(target: str) -> Baseline:
    """Read a baseline.

    Raises:
        UsageError: there is none, it is damaged, or it is of another version.
    """
    try:
        with open(target, "rb") as stream, np.load(stream, allow_pickle=False) as file:
            found = {name: file[name] for name in file.files}
    except OSError as error:
        raise _unusable(target, f"cannot be read ({error.strerror or error})") from None
    except Exception:  # what other bytes than those of an npz file end with is of many kinds
        raise _unusable(target, "is no npz file, or a damaged one") from None
    if str(found.get("format", "")) != FORMAT:
        raise _unusable(target, "holds no baseline")
    if str(found.get("version", "")) != str(VERSION):
        version = shown(str(found.get("version", "none")))
        raise _unusable(target, f"is of version {version}", f"version {VERSION}; save it again")
    try:
        head = json.loads(str(found["head"]))
        scenes = {one["scene"]: _scene(one, found) for one in head["scenes"]}
        return Baseline(target, str(head["program"]), scenes)
    except Exception as error:  # likewise of a head that is not ours
        raise _unusable(target, f"does not hold a whole baseline ({shown(str(error))})") from None


def _scene(head: Mapping[str, Any], arrays: Mapping[str, NDArray[Any]]) -> SavedScene:
    def filled(content: Any) -> Any:
        """The same with each array in the place of its number."""
        if isinstance(content, Mapping):
            return {key: filled(value) for key, value in content.items()}
        return arrays[f"a{content}"] if isinstance(content, int) else content

    found = [filled(one) for one in head["solutions"]]
    solutions = tuple(
        Solution(one["formulation"], one["times"], one["numbers"], Accuracy(one["condition"], one["claims"]))
        for one in found
    )
    for solution in solutions:
        given(solution, solution.times)
        if unknown := solution.numbers.keys() - QUANTITIES.keys():
            raise ValueError(f"{sorted(unknown)[0]} is no quantity")
    return SavedScene(head["mechanism"], head["motion"], solutions)


def _unusable(target: str, problem: str, allowed: str = ALLOWED) -> UsageError:
    return UsageError(f"baseline {target}: {problem}; allowed: {allowed}")
