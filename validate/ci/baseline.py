r"""Baselines: the solved numbers of a run with their error bounds, and the numbers that have moved since.

A number x0 with error bound e0 in the baseline and x with error bound e now can both be right only if

    |x - x0| <= e0 + e + eps^2 M        (see `comparison.pair`).

Beyond this bound the number has moved: one of the error bounds is wrong. Within the bound both may be right,
although their bits may differ.

The file is an npz with `format`, `version`, `head` (a JSON text), and arrays `a0`, `a1`, ...; reading it runs
no code. The head has `program`, the version that wrote the file, and `scenes`. A scene has `scene`, its name;
`mechanism`, the car's type, axes and points; `motion`, a SHA-256 of its inputs and time; and `solutions`. A
solution has `formulation`, and the indices of its arrays: `times` (s) and `condition`, (N,); `numbers` and
`claims`, their error bounds, by quantity and name, (N, 3) or (N,), in the units of pointcoord's quantities.
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
from validate.arrays import Array
from validate.comparison.compare import Comparison, Outcome, compare_solutions
from validate.comparison.given import given, usable
from validate.errors import UsageError
from validate.exit_status import ExitStatus
from validate.formulations.protocol import Accuracy, Solution
from validate.output.document import program_version
from validate.plain_text import named, shown

FORMAT, VERSION = "pointcoord baseline", 1
PARTS = ("times", "condition", "numbers", "claims")
"""The parts of a solution that are stored as arrays."""

Standing = Literal["compared", "new", "gone", "not solved now", "another car", "another motion"]
UNTOLD = ("new", "gone", "not solved now")
"""Scenes of which the baseline requires nothing; other scenes that are not compared have no verdict."""
MoveVerdict = Literal["agrees", "moved", "not tested", "new", "gone"]
WHY: Mapping[MoveVerdict, str] = {
    "moved": "by more than the sum of both error bounds",
    "new": "not in the baseline",
    "gone": "in the baseline and not given now",
    "not tested": "one error bound is too wide to test the other",
}


@dataclass(frozen=True)
class Move:
    """How far one quantity of one point, body or angle has moved since the baseline.

    Attributes:
        row: the comparison of the formulation's numbers then and now: the difference is the movement, the
            tolerance is the sum of both error bounds; NaN if only one of the two runs has the number.
        verdict: `moved` if beyond the tolerance; `new` if not in the baseline; `gone` if no longer given.
    """

    row: Comparison
    verdict: MoveVerdict

    @property
    def formulation(self) -> str:
        """The formulation that gives the numbers."""
        return self.row.first


@dataclass(frozen=True)
class Since:
    """A scene compared with the baseline.

    Attributes:
        standing: whether the scene could be compared, and if not, why.
        words: details, such as which parts of the car differ, or which formulation was replaced.
        replaced: whether the run has a formulation that the baseline lacks in place of one of the baseline's.
            A different name may be a different solver, so whether its numbers have moved is not known.
    """

    scene: str
    standing: Standing
    words: str = ""
    moves: tuple[Move, ...] = ()
    replaced: bool = False

    @property
    def compared(self) -> bool:
        """Whether any number could be compared with the baseline."""
        return any(move.verdict not in ("new", "gone") for move in self.moves)

    @property
    def moved(self) -> tuple[Move, ...]:
        """The numbers that moved by more than the sum of both error bounds."""
        return tuple(move for move in self.moves if move.verdict == "moved")

    @property
    def lost(self) -> tuple[Move, ...]:
        """The numbers that a formulation of this run gave in the baseline and does not give now."""
        here = {move.formulation for move in self.moves if move.verdict != "gone"}
        return tuple(move for move in self.moves if move.verdict == "gone" and move.formulation in here)

    @property
    def status(self) -> ExitStatus:
        """The exit status of the scene's movement alone.

        A scene that is new, or refused now, has no movement; a refusal has its own status. Numbers of a
        formulation that this run does not use are ignored, unless another formulation replaces it.
        """
        if self.moved or self.lost:
            return ExitStatus.DISAGREE
        tested = self.compared and all(move.verdict != "not tested" for move in self.moves)
        decided = self.standing in UNTOLD or (tested and not self.replaced)
        return ExitStatus.AGREE if decided else ExitStatus.NO_VERDICT


@dataclass(frozen=True)
class Kept:
    """A scene in a baseline; see the description of the file at the top of this module."""

    mechanism: Mapping[str, Any]
    motion: str
    solutions: tuple[Solution, ...]

    @classmethod
    def of(cls, scene: Scene, outcomes: Iterable[Outcome]) -> Kept:
        """A compared scene: the usable solution of each formulation, once."""
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
    """The numbers of an earlier run.

    Attributes:
        target: the file. program: version of the program that wrote it. scenes: the scenes by name.
    """

    target: str
    program: str
    scenes: Mapping[str, Kept]

    def since(self, name: str, scene: Scene, outcomes: Sequence[Outcome], factor: float = 1.0) -> Since:
        """Compare a scene with the baseline.

        Args:
            outcomes: all comparisons of the scene in this run. factor: multiple of the bound that is allowed.
        """
        then, now = self.scenes.get(name), Kept.of(scene, outcomes)
        if then is None:
            return Since(name, "new", f"{name} is not in the baseline")
        if other := ", ".join(_differing(then.mechanism, now.mechanism)):
            words = f"{name} is a different car in the baseline; differences: {other}"
            return Since(name, "another car", words)
        if now.motion != then.motion:
            words = f"{name} has different inputs or another time in the baseline"
            return Since(name, "another motion", words)
        if not outcomes:
            return Since(name, "not solved now", f"{name} is in the baseline and has no comparison now")
        before, after = ({one.formulation: one for one in kept.solutions} for kept in (then, now))
        moves = tuple(_moves(name, scene, before, after, factor))
        lacking, others = (", ".join(sorted(some)) for some in (before.keys() - after, after.keys() - before))
        replaced = bool(lacking and others)
        words = (
            f"{name} has another formulation than in the baseline, {others} instead of {lacking}, so their "
            "numbers cannot be compared"
        )
        return Since(name, "compared", words if replaced else "", moves, replaced)


def baseline_data(baseline: Baseline, found: Sequence[Since], gone: Sequence[Since]) -> dict[str, Any]:
    """The comparison of a run with its baseline as plain data."""
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
    name: str, scene: Scene, before: Mapping[str, Solution], after: Mapping[str, Solution], factor: float
) -> Iterator[Move]:
    """The movement of every number that a formulation gives in either run."""
    for formulation in dict.fromkeys((*after, *before)):
        # A run without this formulation has no numbers of it.
        nothing = Solution(formulation, np.empty(0), {}, Accuracy(np.empty(0)))
        one, two = before.get(formulation, nothing), after.get(formulation, nothing)
        asked = {q: tuple({**one.numbers.get(q, {}), **two.numbers.get(q, {})}) for q in QUANTITIES}
        for row in compare_solutions(scene, one, two, name, asked, factor).rows:
            there = row.name in one.numbers.get(row.quantity, ())
            verdict: MoveVerdict = "moved"
            if row.verdict == "not given":
                verdict = "gone" if there else "new"
            elif row.verdict != "disagrees":
                verdict = row.verdict
            yield Move(row, verdict)


def _differing(then: Mapping[str, Any], now: Mapping[str, Any]) -> Iterator[str]:
    """The keys and the points of a car that differ."""
    for key in sorted(then.keys() | now.keys()):
        before, after = then.get(key), now.get(key)
        if isinstance(before, Mapping) and isinstance(after, Mapping):
            yield from (n for n in sorted(before.keys() | after.keys()) if before.get(n) != after.get(n))
        elif before != after:
            yield key


def written(scenes: Mapping[str, Kept]) -> bytes:
    """The file of a baseline with some scenes, by name; a scene of 100 instants takes half a megabyte."""
    arrays: dict[str, Any] = {}

    def number_of(array: Array) -> int:
        arrays[f"a{len(arrays)}"] = array
        return len(arrays) - 1

    def plain(one: Solution) -> dict[str, Any]:
        parts = one.times, one.accuracy.condition, one.numbers, one.accuracy.claims
        numbered = (_each(part, number_of) for part in parts)
        return {"formulation": one.formulation, **dict(zip(PARTS, numbered, strict=True))}

    kept = [
        {"scene": name, **vars(one), "solutions": [*map(plain, one.solutions)]}
        for name, one in scenes.items()
    ]
    head = json.dumps({"program": program_version(), "scenes": kept})
    stream = io.BytesIO()
    np.savez_compressed(stream, **arrays, format=FORMAT, version=VERSION, head=head)
    return stream.getvalue()


def _each(content: Any, change: Callable[[Any], Any]) -> Any:
    """Apply `change` to an array, or to each array of a mapping: from array to index in the file, or back."""
    if isinstance(content, Mapping):
        return {key: _each(value, change) for key, value in content.items()}
    return change(content)


def read_baseline(target: str) -> Baseline:
    """Read a baseline.

    Raises:
        UsageError: the file cannot be read, is damaged, or has another version.
    """
    try:
        with open(target, "rb") as stream, np.load(stream, allow_pickle=False) as file:
            found = {name: file[name] for name in file.files}
        if (kind := f"{found['format']} {found['version']}") != f"{FORMAT} {VERSION}":
            raise ValueError(f"it is a {kind}")
        head = json.loads(str(found["head"]))
        scenes = {one["scene"]: _kept(one, found) for one in head["scenes"]}
        return Baseline(target, str(head["program"]), scenes)
    except Exception as error:  # a damaged file and a foreign one raise many kinds of errors
        why = shown((error.strerror if isinstance(error, OSError) else None) or named(error))
        raise UsageError(
            f"baseline {target}: no baseline, or a damaged one ({why}); allowed: a file that --save-baseline "
            "of this version wrote"
        ) from None


def _kept(head: Mapping[str, Any], arrays: Mapping[str, NDArray[Any]]) -> Kept:
    solutions = []
    for one in head["solutions"]:
        times, condition, numbers, claims = (_each(one[part], lambda n: arrays[f"a{n}"]) for part in PARTS)
        solution = Solution(one["formulation"], times, numbers, Accuracy(condition, claims))
        given(solution, solution.times)
        if unknown := solution.numbers.keys() - QUANTITIES.keys():
            raise ValueError(f"{sorted(unknown)[0]} is not a quantity")
        solutions.append(solution)
    return Kept(head["mechanism"], head["motion"], tuple(solutions))
