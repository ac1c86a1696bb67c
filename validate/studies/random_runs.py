"""Random scenes by the hundred thousand through both models.

    python -m validate.studies.random_runs --store FILE
    python -m validate.studies.random_runs --store FILE --ours pointcoord-map --count 60

Every scene has one outcome: both models agree, both refuse, one refuses, they disagree, or one of them fails
in a way it should not. Two models may agree on a wrong car, so where they agree one scene in twenty is held
to the reference, in every quantity. Nothing is folded away: the table at the end counts them all.

The store goes on where it ended, whatever ended it. It belongs to one state of the models: after a change to
them, or for another of pointcoord's methods, give another file.
"""

from __future__ import annotations

import argparse
import multiprocessing
import os
import sys
import time
import warnings
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from pointcoord import SceneError
from validate.adjudication.verdicts import (
    NEITHER_WRONG,
    NO_OBSTACLE,
    judged,
    judged_alone,
    obstacle,
    unanswered,
)
from validate.cars.random_cars import KINDS
from validate.cars.random_scenes import SEED, RandomScene, random_scene
from validate.cars.registry import VARIANTS
from validate.comparison.compare import Outcome, compare_solutions
from validate.exit_status import ExitStatus
from validate.formulations.protocol import FormulationError, Solution
from validate.formulations.refusals import same_reason, why_refused
from validate.formulations.registry import formulation
from validate.output.report import table
from validate.studies.chunk_store import CHUNK, OURS, Chunk, Record, Store, StoreError

OTHER = "absolute"
METHODS = (OURS, "pointcoord-map", "pointcoord-newton")
ALONE = 1.0 - 1e-9  # a part of a tolerance that is all of it
HELD = 20  # every so many scenes are held to the reference although both models agree
# What makes the status 1; an answer that stands alone and is wrong is one of them.
FAULTY = (
    "disagreed",
    " fails: ",
    "agreed, the reference: pointcoord",
    "agreed, the reference: absolute",
    "agreed, the reference: no such pose",
    "answer wrong",
)


# How outcomes begin, in the order in which they are shown.
HEADS = ("agreed", "not tested", "not given", "both refuse", "only", "disagreed")


@dataclass(frozen=True)
class Result:
    """What came of one scene.

    Attributes:
        outcome: the class that it is counted in.
        reason: what there is to say of this scene alone; empty if nothing.
        shares: per quantity, the largest share of its tolerance, where both models answered.
        kept: whether the scene is written down.
    """

    outcome: str
    reason: str
    shares: dict[str, float]
    kept: bool


def examine(car: RandomScene, ours: str = OURS) -> Result:
    """Solve one scene by both models and say what came of it.

    Args:
        ours: by which of pointcoord's methods.
    """
    answers: list[Solution | FormulationError] = []
    for name in (ours, OTHER):
        try:
            answers.append(_solved(name, car))
        except FormulationError as error:
            answers.append(error)
        # Any other error is a defect of a model: it is counted and written down, and the run goes on.
        except Exception as error:
            return Result(f"{name} fails: {type(error).__name__}", " ".join(str(error).split()), {}, True)
    first, second = answers
    if isinstance(first, Solution) and isinstance(second, Solution):
        return _compared(car, first, second)
    if isinstance(first, FormulationError) and isinstance(second, FormulationError):
        reasons = why_refused(first), why_refused(second)
        shown = reasons[0] if reasons[0] == reasons[1] else " | ".join(reasons)
        alike = "same reason" if same_reason(*reasons) else "different reasons"
        why = unanswered(car.scene)
        # A refusal that nothing explains is worth a look, even if both models agree in it.
        return Result(f"both refuse, {alike}: {shown}: {why}", _told(first), {}, why == NO_OBSTACLE)
    return _one_sided(car, answers)


def _solved(name: str, car: RandomScene) -> Solution:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        try:
            return formulation(name).solve(car.scene)
        except SceneError as error:
            raise FormulationError(name, error) from error


def _compared(car: RandomScene, first: Solution, second: Solution) -> Result:
    outcome = compare_solutions(car.scene, first, second, car.scene.title)
    if outcome.agreed and car.number % HELD:
        return Result("agreed", "", _shares(outcome), False)
    if outcome.agreed:
        verdict = judged(car.scene, first, second)
        right = verdict == NEITHER_WRONG
        name = "agreed, and with the reference" if right else f"agreed, the reference: {verdict}"
        return Result(name, "", _shares(outcome), not right)
    worst = (*outcome.disagreements, *outcome.undecided)[0]
    reason = (
        f"{worst.quantity} of {worst.name} differs by {worst.difference:.3g} {worst.unit}, "
        f"tolerance {worst.tolerance:.3g}, at t = {worst.instant:.6g} s"
    )
    if worst.verdict != "disagrees":
        said = f", {worst.part:.6f} of it what {worst.rests_on} claims"
        return Result(f"{worst.verdict}: {worst.quantity}", reason + said, {}, True)
    kind = f"disagreed in {worst.quantity}: {judged(car.scene, first, second)}"
    return Result(kind, reason, {}, True)


def _one_sided(car: RandomScene, answers: Sequence[Solution | FormulationError]) -> Result:
    (error,) = (a for a in answers if isinstance(a, FormulationError))
    (answer,) = (a for a in answers if isinstance(a, Solution))
    verdict = judged_alone(car.scene, answer)
    if verdict == "answer right":
        verdict += f", {obstacle(car.scene)}"
    outcome = f"only {error.formulation} refuses, {why_refused(error)}: {verdict}"
    return Result(outcome, _told(error), {}, True)


def _told(error: FormulationError) -> str:
    return " ".join(str(error.reason).split())


def _shares(outcome: Outcome) -> dict[str, float]:
    """Largest share of each quantity, and of each wheel angle.

    Where one model claims nothing, as of a point at rest, a share says nothing of what both claim.
    """
    largest: dict[str, float] = {}
    for row in outcome.rows:
        if row.part < ALONE:
            what = row.name if row.quantity == "wheel" else row.quantity
            largest[what] = max(largest.get(what, 0.0), row.share)
    return largest


def run_chunk(number: int, store: Store, known: frozenset[int]) -> Chunk:
    """Do the scenes of one chunk and record it; findings of the scenes in `known` are there already."""
    began = time.perf_counter()
    outcomes: Counter[str] = Counter()
    shares: dict[str, tuple[float, int]] = {}
    found = []
    for index in range(number * CHUNK, (number + 1) * CHUNK):
        car = random_scene(index)
        result = examine(car, store.ours)
        outcomes[f"{car.variant.words}/{car.kind}/{result.outcome}"] += 1
        for quantity, share in result.shares.items():
            shares[quantity] = max(shares.get(quantity, (share, index)), (share, index))
        if result.kept:
            found.append(index)
            if index not in known:
                data = car.scene.model_dump(mode="json", exclude_none=True)
                line = {
                    "suspension": car.variant.words,
                    "kind": car.kind,
                    "outcome": result.outcome,
                    "reason": result.reason,
                    "content": data,
                }
                store.finding(index, line)
    chunk = Chunk(number, dict(outcomes), shares, tuple(found), time.perf_counter() - began)
    store.chunk(chunk)
    return chunk


def _work(numbers: Sequence[int], path: Path, known: frozenset[int], parent: int, ours: str) -> None:
    for number in numbers:
        run_chunk(number, Store(path, SEED, ours), known)
        # A worker whose parent was killed would go on unseen, beside the run that is started next.
        if os.getppid() != parent:
            return


def run(count: int, path: Path, workers: int = 1, ours: str = OURS) -> int:
    """Do what is missing of the first `count` scenes, print the table, return the exit status.

    Args:
        ours: by which of pointcoord's methods; a store holds the scenes of one.
    Raises:
        StoreError: the store cannot be used, or a worker died.
    """
    store = Store(path, SEED, ours)
    record = store.read()
    wanted = range(-(-count // CHUNK))
    missing = [n for n in wanted if n not in record.chunks]
    known = frozenset(record.findings)
    if workers == 1:
        for number in missing:
            run_chunk(number, store, known)
    else:
        context = multiprocessing.get_context("spawn")
        crew = [
            context.Process(
                target=_work, args=(missing[i::workers], path, known, os.getpid(), ours), daemon=True
            )
            for i in range(workers)
        ]
        for process in crew:
            process.start()
        for process in crew:
            process.join()
        if any(process.exitcode for process in crew):
            raise StoreError(f"{path}: a worker died; start again, and it goes on from what is recorded")
    record = store.read()
    print(table_text(record), flush=True)
    return 1 if any(word in o for o in record.outcomes() for word in FAULTY) else 0


def table_text(record: Record) -> str:
    """Every outcome by suspension and by kind of scene, and the largest share of each tolerance."""
    total = record.outcomes()
    blocks = [_summary(total)]
    blocks += [f"{variant.words}:\n{_outcomes(total, variant.words)}" for variant in VARIANTS]
    shares = record.shares()
    if shares:
        lines = [(q.replace("_", " "), f"{share:.3g}", str(scene)) for q, (share, scene) in shares.items()]
        blocks.append(
            "Where both agreed:\n" + table(("quantity", "largest share of tolerance", "scene"), lines)
        )
    seconds = sum(chunk.seconds for chunk in record.chunks.values())
    blocks.append(
        f"{len(record.chunks)} chunks of {CHUNK} scenes, {len(record.findings)} scenes written down, "
        f"{record.torn} torn lines ignored, {seconds:.0f} s."
    )
    return "\n\n".join(blocks)


def _summary(total: Counter[str]) -> str:
    """A row for each suspension and closure."""
    rows = []
    for variant in VARIANTS:
        here = {key: n for key, n in total.items() if key.startswith(f"{variant.words}/")}
        begun = [sum(n for key, n in here.items() if key.split("/", 2)[2].startswith(h)) for h in HEADS]
        faulty = sum(n for key, n in here.items() if any(word in key for word in FAULTY))
        rows.append((variant.words, *map(str, (sum(here.values()), *begun, faulty))))
    return table(("suspension", "scenes", *HEADS, "of these wrong"), rows)


def _outcomes(total: Counter[str], suspension: str) -> str:
    here = [key for key in total if key.startswith(f"{suspension}/")]
    outcomes = sorted({key.split("/", 2)[2] for key in here}, key=_order)
    rows = []
    for outcome in outcomes:
        counts = [total[f"{suspension}/{kind}/{outcome}"] for kind in KINDS]
        rows.append((outcome, str(sum(counts)), *(str(count) for count in counts)))
    tried = [sum(total[key] for key in here if key.startswith(f"{suspension}/{kind}/")) for kind in KINDS]
    rows.append(("mechanisms tried", str(sum(tried)), *(str(n) for n in tried)))
    return table(("outcome", "all", *KINDS), rows)


def _order(outcome: str) -> tuple[int, str]:
    return next((i for i, head in enumerate(HEADS) if outcome.startswith(head)), len(HEADS)), outcome


def main(arguments: Sequence[str] | None = None) -> int:
    """Run from the command line."""
    parser = argparse.ArgumentParser(prog="python -m validate.studies.random_runs", description=__doc__)
    parser.add_argument(
        "--count", type=int, default=100_000, help=f"scenes, rounded up to {CHUNK}s; 0: the table only"
    )
    parser.add_argument("--store", type=Path, required=True, help="file of JSON lines; goes on where it ends")
    parser.add_argument("--ours", choices=METHODS, default=OURS, help="by which of pointcoord's methods")
    parser.add_argument("--workers", type=int, default=1, help="processes")
    options = parser.parse_args(arguments)
    if options.count < 0 or options.workers < 1:
        parser.error(f"--count {options.count} --workers {options.workers}: allowed: from 0, from 1")
    try:
        return run(options.count, options.store, options.workers, options.ours)
    except StoreError as error:
        print(f"validate.studies.random_runs: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print(
            f"validate.studies.random_runs: stopped; start again with --store {options.store} to go on",
            file=sys.stderr,
        )
        return ExitStatus.INTERRUPTED


if __name__ == "__main__":
    sys.exit(main())
