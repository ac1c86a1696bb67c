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
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
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
PARTS = ("times", "condition", "numbers", "claims")
"""Of a solution, what stands in arrays of their own."""
ALLOWED = "a file that --save-baseline wrote"
NEVER = np.empty(0)  # the instants at which a run gives what it does not give

Standing = Literal["compared", "new", "gone", "not solved now", "another car", "another motion"]
UNTOLD = ("new", "gone", "not solved now")
"""Of these a baseline says nothing; of others that are not compared there is no verdict."""
MoveVerdict = Literal["agrees", "moved", "not tested", "new", "gone"]
WHY: Mapping[MoveVerdict, str] = {
    "moved": "by more than both error bounds together",
    "new": "not in the baseline",
    "gone": "in the baseline and not given now",
    "not tested": "one error bound is too wide to test the other",
}


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
        tested = self.compared and all(move.verdict != "not tested" for move in self.moves)
        told = self.standing in UNTOLD or (tested and not self.replaced)
        return ExitStatus.AGREE if told else ExitStatus.NO_VERDICT


@dataclass(frozen=True)
class Kept:
    """What a baseline keeps of a scene; see the file's description."""

    mechanism: Mapping[str, Any]
    motion: str
    solutions: tuple[Solution, ...]

    @classmethod
    def of(cls, scene: Scene, outcomes: Iterable[Outcome]) -> Kept:
        """Of a scene that was compared: each formulation's solution once, as a comparison takes it."""
        solutions: dict[str, Solution] = {}
        for solution in (solution for outcome in outcomes for solution in outcome.solutions):
            solutions.setdefault(solution.formulation, solution)
        motion = json.dumps(scene.model_dump(mode="json", include={"inputs", "time"}), sort_keys=True)
        return cls(
            mechanism=scene.mechanism.model_dump(mode="json"),
            motion=hashlib.sha256(motion.encode()).hexdigest(),
            solutions=tuple(usable(solution, scene.instants) for solution in solutions.values()),
        )


@dataclass(frozen=True)
class Baseline:
    """What a run solved once.

    Attributes:
        target: the file. program: version of the program that wrote it. scenes: by name.
    """

    target: str
    program: str
    scenes: Mapping[str, Kept]

    def since(self, name: str, scene: Scene, outcomes: Sequence[Outcome], factor: float = 1.0) -> Since:
        """What of a scene moved.

        Args:
            outcomes: all that the scene was compared in now. factor: how many times the bound is allowed.
        """
        then, now = self.scenes.get(name), Kept.of(scene, outcomes)
        if then is None:
            return Since(name, "new", f"{name} is not in the baseline")
        if other := ", ".join(_differing(then.mechanism, now.mechanism)):
            return Since(name, "another car", f"{name} is another car than in the baseline: {other}")
        if now.motion != then.motion:
            words = f"{name} has other inputs or another time than in the baseline"
            return Since(name, "another motion", words)
        if not outcomes:
            return Since(name, "not solved now", f"{name} is in the baseline and has no comparison now")
        moves = tuple(_moves(name, scene, then.solutions, now.solutions, factor))
        before, after = ({one.formulation for one in kept.solutions} for kept in (then, now))
        lacking, others = (", ".join(sorted(some)) for some in (before - after, after - before))
        if not lacking or not others:
            return Since(name, "compared", "", moves)
        words = (
            f"{name} has another formulation than in the baseline: {others} in the place of {lacking}, of "
            "which no number could be compared with it"
        )
        return Since(name, "compared", words, moves, replaced=True)


def baseline_data(baseline: Baseline, found: Sequence[Since], gone: Sequence[Since]) -> dict[str, Any]:
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
        "gone": [since.scene for since in gone],
    }


def _moves(
    name: str, scene: Scene, then: Sequence[Solution], now: Sequence[Solution], factor: float
) -> Iterator[Move]:
    before, after = ({one.formulation: one for one in some} for some in (then, now))
    for formulation in dict.fromkeys((*after, *before)):
        # A run that has no such formulation has no number of it.
        nothing = Solution(formulation, NEVER, {}, Accuracy(NEVER))
        one, two = before.get(formulation, nothing), after.get(formulation, nothing)
        asked = {q: tuple({**one.numbers.get(q, {}), **two.numbers.get(q, {})}) for q in QUANTITIES}
        for row in compare_solutions(scene, one, two, name, asked, factor).rows:
            yield Move(row, _verdict(row, one))


def _verdict(row: Comparison, then: Solution) -> MoveVerdict:
    if row.verdict == "not given":
        return "gone" if row.name in then.numbers.get(row.quantity, ()) else "new"
    return "moved" if row.verdict == "disagrees" else row.verdict


def _differing(then: Mapping[str, Any], now: Mapping[str, Any]) -> Iterator[str]:
    """The keys of a car that are other ones, and of its points those that are."""
    for key in sorted(then.keys() | now.keys()):
        before, after = then.get(key), now.get(key)
        if isinstance(before, Mapping) and isinstance(after, Mapping):
            yield from (n for n in sorted(before.keys() | after.keys()) if before.get(n) != after.get(n))
        elif before != after:
            yield key


def written(scenes: Mapping[str, Kept]) -> bytes:
    """The file of a baseline, of scenes by name; one of 100 instants takes half a megabyte."""
    arrays: dict[str, Any] = {}

    def number_of(array: Array) -> int:
        arrays[f"a{len(arrays)}"] = array
        return len(arrays) - 1

    def plain(one: Solution) -> dict[str, Any]:
        parts = one.times, one.accuracy.condition, one.numbers, one.accuracy.claims
        numbered = (_each(part, number_of) for part in parts)
        return {"formulation": one.formulation, **dict(zip(PARTS, numbered, strict=True))}

    kept = [
        {
            "scene": name,
            "mechanism": one.mechanism,
            "motion": one.motion,
            "solutions": [*map(plain, one.solutions)],
        }
        for name, one in scenes.items()
    ]
    head = json.dumps({"program": program_version(), "scenes": kept})
    stream = io.BytesIO()
    np.savez_compressed(stream, **arrays, format=FORMAT, version=VERSION, head=head)
    return stream.getvalue()


def _each(content: Any, change: Callable[[Any], Any]) -> Any:
    """Arrays by quantity and name, or one, each changed into its number in the file or back."""
    if isinstance(content, Mapping):
        return {key: _each(value, change) for key, value in content.items()}
    return change(content)


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
        scenes = {one["scene"]: _kept(one, found) for one in head["scenes"]}
        return Baseline(target, str(head["program"]), scenes)
    except Exception as error:  # likewise of a head that is not ours
        raise _unusable(target, f"does not hold a whole baseline ({shown(str(error))})") from None


def _kept(head: Mapping[str, Any], arrays: Mapping[str, NDArray[Any]]) -> Kept:
    solutions = []
    for one in head["solutions"]:
        times, condition, numbers, claims = (_each(one[part], lambda n: arrays[f"a{n}"]) for part in PARTS)
        solution = Solution(one["formulation"], times, numbers, Accuracy(condition, claims))
        given(solution, solution.times)
        if unknown := solution.numbers.keys() - QUANTITIES.keys():
            raise ValueError(f"{sorted(unknown)[0]} is no quantity")
        solutions.append(solution)
    return Kept(head["mechanism"], head["motion"], tuple(solutions))


def _unusable(target: str, problem: str, allowed: str = ALLOWED) -> UsageError:
    return UsageError(f"baseline {target}: {problem}; allowed: {allowed}")
