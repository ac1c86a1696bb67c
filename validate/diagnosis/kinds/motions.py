"""The same car moved otherwise: by inputs that are taken otherwise, or earlier or later.

Each wrong input x is taken as k x + m: with the other sign, as pi minus it, k times, so much more. k or m of
one input, then k and m of all together, are found by least squares.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from pointcoord import Motion
from pointcoord.numerics.rounding import EPS
from pointcoord.scene.input_part import InputPart
from validate.diagnosis.evidence import Evidence, Row, Solved, motion_of, numbers_in, some_of
from validate.diagnosis.hypothesis import Hypothesis, Parameters, WouldBe, by_what_tells, gives
from validate.diagnosis.least import fitted
from validate.formulations.input_rates import rates

Array = NDArray[np.float64]
Taken = Mapping[str, tuple[float, float]]
"""k and m by input."""

OURS = (1.0, 0.0)
STEP = 1e-3  # of differences by k and m
# How near to a number of six digits a found one is meant to be that number, and to pi to be it.
MEANT, NEAR = 1e-8, 1e-5
FEW = 256  # instants that a shift is found from, and shifts by whole instants that are tried
# Instants of which one at an end may be left out, and that are looked through twice more in a second or two.
FEWEST_LATE, MOST_LATE = 8, 2000


def wrong_inputs(evidence: Evidence) -> Iterator[Hypothesis]:
    """Simple before far-fetched, and no more of these where something explains all."""
    return by_what_tells(evidence, partial(_wrong, evidence))


def _wrong(evidence: Evidence, looked: Sequence[Row], several: bool) -> list[Hypothesis]:
    """One number of an input by itself; all together if several are looked for and this does not do."""
    sizes = {name: np.abs(rates(law, evidence.times)[:, 0]) for name, law in evidence.scene.inputs.items()}
    # Of an input that stands still k and m are one, of one at 0 only m.
    single = [[(name, 0)] for name in sizes if sizes[name].any()] + [[(name, 1)] for name in sizes]
    every = [(name, which) for name in sizes for which in (0, 1) if which or np.ptp(sizes[name]) > 0.0]
    found: list[Hypothesis] = []
    for stage in (single, [every]) if several else (single,):
        for places in stage:
            # An amount is little beside numbers of the law's own size.
            largest = [1.0 if which == 0 else float(sizes[name].max()) or 1.0 for name, which in places]
            found += _taken_otherwise(evidence, looked, places, largest)
        if any(gives(evidence, one, looked) for one in found):
            break
    return found


def _taken_otherwise(
    evidence: Evidence, looked: Sequence[Row], places: Sequence[tuple[str, int]], sizes: Sequence[float]
) -> Iterator[Hypothesis]:
    """By other k (0) and m (1) of some inputs, of those only that are found not to be ours."""

    def taken(values: Sequence[float]) -> Taken:
        said = dict(zip(places, values, strict=True))
        names = dict.fromkeys(name for name, _ in places)
        return {name: (said.get((name, 0), OURS[0]), said.get((name, 1), OURS[1])) for name in names}

    start = tuple(OURS[which] for _, which in places)
    numbers = Parameters(tuple(places), start, STEP, lambda *values: _motion(evidence, taken(values)))
    found = numbers.amounts(evidence, looked, rounded=False) or start
    meant = taken([_meant(*one) for one in zip(found, sizes, strict=True)])
    meant = {name: km for name, km in meant.items() if km != OURS}
    motion = _motion(evidence, meant) if meant else None
    if motion is not None:
        changed = sum((abs(k) != 1.0) + (m != 0.0) for k, m in meant.values())
        words = ", and ".join(f"the input {name} {_said(evidence, name, *km)}" for name, km in meant.items())
        cost = 1.2 + 0.2 * changed + 0.1 * len(meant)
        yield Hypothesis(tuple(meant.items()), words, evidence.by(motion), changed, cost, whole=True)


def _meant(amount: float, size: float) -> float:
    """What an amount is meant to be: 0, 1 or -1, or a number of six digits, where that is nearly it."""
    near = {0.0: size, 1.0: 1.0, -1.0: 1.0, float(f"{amount:.6g}"): abs(amount)}
    return next((one for one, scale in near.items() if abs(amount - one) <= MEANT * scale), amount)


def _motion(evidence: Evidence, taken: Taken) -> Motion | None:
    scene = evidence.solved.ends
    laws = {name: _changed(scene.inputs[name], *km) for name, km in taken.items()}
    return motion_of(lambda: scene.model_copy(update={"inputs": {**scene.inputs, **laws}}))


def _changed(law: InputPart, factor: float, more: float) -> InputPart:
    """A law times a factor, and a constant more."""
    if law.sum is not None:
        moreover = (more, *[0.0] * (len(law.sum) - 1))
        terms = tuple(_changed(term, factor, m) for term, m in zip(law.sum, moreover, strict=True))
        return law.model_copy(update={"sum": terms})
    if law.sine is not None:
        wave = law.sine
        update = {"amplitude": factor * wave.amplitude, "offset": factor * wave.offset + more}
        return law.model_copy(update={"sine": wave.model_copy(update=update)})
    if law.table is not None:
        values = tuple(factor * value + more for value in law.table.values)
        return law.model_copy(update={"table": law.table.model_copy(update={"values": values})})
    first, *others = law.polynomial or (law.constant or 0.0,)
    return InputPart(polynomial=(factor * first + more, *(factor * value for value in others)))


def _said(evidence: Evidence, name: str, factor: float, more: float) -> str:
    """An input that is taken as k times itself and so much more, in words."""
    unit = evidence.scene.mechanism.topology.input_units[name]
    by = f"{abs(more):.6g} {unit} {'more' if more > 0.0 else 'less'}"
    if factor == 1.0:
        return f"is taken {by}"
    if more == 0.0:
        return {-1.0: "has the other sign", 0.0: "is taken as 0"}.get(factor, f"is taken {factor:.6g} times")
    if factor == -1.0:
        whole = "pi" if unit == "rad" and abs(more - np.pi) <= NEAR else f"{more:.6g} {unit}"
        return f"is taken as {whole} minus it"
    if factor == 0.0:
        return f"is taken as {more:.6g} {unit} all the time"
    return f"is taken {factor:.6g} times and {by}"


def shifted_in_time(evidence: Evidence) -> Iterator[Hypothesis]:
    """Their numbers at t are ours at t + s, of the whole car: s from the grid, then by least squares."""
    times, looked = evidence.times, evidence.telling[0]
    if len(times) < 5 or evidence.solved.motion is None:
        return
    ours, theirs = (
        np.concatenate([part[row].reshape(len(times), -1) for row in looked], axis=1)
        for part in (evidence.held, evidence.given)
    )
    spread = np.ptp(ours, axis=0)
    used = spread > 1e-9 * np.abs(ours).max(axis=0)
    if not np.isfinite(theirs).all() or not used.any():
        return
    pad = 2.0 * float(np.diff(times).max())
    whole = _on_the_grid(times, theirs[:, used] / spread[used], ours[:, used] / spread[used])
    motion, first, last = _longer(evidence, min(0.0, whole - pad), max(0.0, whole + pad))
    some = some_of(len(times), FEW)
    some = some[(times[some] + whole - pad >= first) & (times[some] + whole + pad <= last)]
    if len(some) < 5:
        return

    def read(shifts: Array) -> Array:
        found = [motion.at(times[some] + whole + np.clip(shift, -pad, pad)).numbers for (shift,) in shifts]
        return np.stack([numbers_in(one, looked) for one in found])

    rest = fitted(read, [0.0], 1e-4 * pad, evidence.joined(looked, some)[0])
    # Where whole instants leave nothing but rounding, there is nothing to find.
    shift = whole + (0.0 if rest is None else float(rest.amounts[0]))
    if abs(shift) <= 1e-9 * float(np.ptp(times)):
        return
    inside = (times + shift >= first) & (times + shift <= last)
    found = motion.at(np.clip(times + shift, first, last)).numbers
    rows: dict[Row, WouldBe] = {}
    for row in evidence.held:
        if row[1] in found[row[0]]:
            value = np.asarray(found[row[0]][row[1]])
            # The instants are rounded too, and so moves what is read there.
            speed = np.abs(np.gradient(value, times, axis=0)).max()
            # What is claimed varies along the motion: the most of it, since it is read elsewhere.
            most = np.broadcast_to(evidence.rounded(row).max(axis=0), value.shape)
            allowed = most + 8.0 * EPS * speed * (abs(shift) + np.abs(times).max())
            allowed[~inside] = np.inf
            rows[row] = (value, allowed)
    reach = "" if inside.all() else ", as far as ours reach"
    words = f"the same curves {abs(shift):.6g} s {'later' if shift < 0.0 else 'earlier'}{reach}"
    yield Hypothesis("shift", words, rows, 1, 2.0, whole=True)


def _longer(evidence: Evidence, before: float, after: float) -> tuple[Motion, float, float]:
    """The motion from so much before its first instant to so much after its last, as far as the car goes."""
    motion, scene = evidence.solved.motion, evidence.solved.fine
    first, last = float(evidence.times[0]), float(evidence.times[-1])
    time = scene.time.model_copy(update={"start": first + before, "stop": last + after, "samples": 2})
    longer = motion_of(lambda: scene.model_copy(update={"time": time}))
    if longer is None:
        assert motion is not None  # there is one, or no shift is looked for
        return motion, first, last
    return longer, first + before, last + after


def _on_the_grid(times: Array, theirs: Array, ours: Array) -> float:
    """The shift by whole instants under which both curves are nearest; of many some, then those about it."""
    half, coarse = len(times) // 2, -(-len(times) // FEW)

    def left(k: int) -> float:
        mine, other = (ours[k:], theirs[: len(ours) - k]) if k >= 0 else (ours[:k], theirs[-k:])
        return float(np.mean((mine[::coarse] - other[::coarse]) ** 2))

    best = min(range(-half, half + 1, coarse), key=left)
    best = min(range(max(best - coarse, -half), min(best + coarse, half) + 1), key=left)
    return float(times[best] - times[0]) if best >= 0 else float(times[0] - times[-best])


def without_a_late_sample(evidence: Evidence) -> Iterator[tuple[str, Evidence]]:
    """The same without an end, in words, if every number that changes may be one row late or early."""
    moving = {row for row, values in evidence.held.items() if np.ptp(values, axis=0).max(initial=0.0) > 0.0}
    few = FEWEST_LATE < len(evidence.times) <= MOST_LATE
    if not few or len(evidence.wrong) < 2 or not moving <= {*evidence.wrong}:
        return
    ends = {
        "one sample late": (slice(1, None), slice(None, -1)),
        "one sample early": (slice(None, -1), slice(1, None)),
    }
    for words, (theirs, ours) in ends.items():
        late = evidence.at(ours, theirs)
        limits = {"start": float(late.times[0]), "stop": float(late.times[-1]), "samples": len(late.times)}
        time = evidence.scene.time.model_copy(update=limits)
        scene = evidence.scene.model_copy(update={"time": time})
        yield words, replace(late, scene=scene, solved=Solved(scene), parted=True)
