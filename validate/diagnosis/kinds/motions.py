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

from pointcoord.numerics.rounding import EPS
from validate.diagnosis.evidence import Evidence, Row, Solved, numbers_in, some_of
from validate.diagnosis.hypothesis import Hypothesis, WouldBe
from validate.diagnosis.least import fitted
from validate.diagnosis.other_car import (
    Change,
    Content,
    amounts_of,
    by_what_tells,
    gives,
    motion_by,
    other_motion,
)
from validate.formulations.input_rates import rates

Array = NDArray[np.float64]

OURS = (1.0, 0.0)  # k and m
SCALED = {"amplitude", "offset", "values"}  # of a law, what is so many times itself if the law is
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
    # An amount is little beside numbers of the law's own size.
    largest = {name: (1.0, float(size.max()) or 1.0) for name, size in sizes.items()}
    found: list[Hypothesis] = []
    for stage in (single, [every]) if several else (single,):
        for places in stage:
            amounts = amounts_of(evidence, looked, [_number(*one) for one in places], rounded=False)
            found += _taken(
                evidence,
                {
                    (name, i): meant
                    for (name, i), amount in zip(places, amounts or (), strict=bool(amounts))
                    if (meant := _meant(amount, largest[name][i])) != OURS[i]
                },
            )
        if any(gives(evidence, one, looked) for one in found):
            break
    return found


def _number(name: str, which: int) -> Change:
    """k (0) or m (1) of an input."""

    def put(content: Content, number: float) -> None:
        law = content["inputs"][name]
        moved = {"sum": [law, {"constant": number}]} if which else _times(law, number)
        content["inputs"][name] = moved

    return Change((name, which), OURS[which], STEP, put)


def _times(law: Content, factor: float) -> Content:
    ((kind, of),) = law.items()
    if kind == "sum":
        return {kind: [_times(term, factor) for term in of]}
    if isinstance(of, dict):
        scaled = {key: np.multiply(factor, of[key]).tolist() for key in SCALED & of.keys()}
        return {kind: {**of, **scaled}}
    return {kind: np.multiply(factor, of).tolist()}


def _taken(evidence: Evidence, found: Mapping[tuple[str, int], float]) -> Iterator[Hypothesis]:
    """The whole car by inputs of which some k and m are others."""
    motion = motion_by(evidence, [_number(*one) for one in found], [*found.values()]) if found else None
    if motion is None:
        return
    taken = {name: [found.get((name, i), OURS[i]) for i in (0, 1)] for name, _ in found}
    words = ", and ".join(f"the input {name} {_said(evidence, name, *km)}" for name, km in taken.items())
    count = sum((abs(k) != 1.0) + (m != 0.0) for k, m in taken.values())
    cost = 1.2 + 0.2 * count + 0.1 * len(taken)
    yield Hypothesis(words, words, evidence.by(motion), count, cost, whole=True)


def _meant(amount: float, size: float) -> float:
    """What an amount is meant to be: 0, 1 or -1, or a number of six digits, where that is nearly it."""
    near = {0.0: size, 1.0: 1.0, -1.0: 1.0, float(f"{amount:.6g}"): abs(amount)}
    return next((one for one, scale in near.items() if abs(amount - one) <= MEANT * scale), amount)


def _said(evidence: Evidence, name: str, factor: float, more: float) -> str:
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
    if len(times) < 5:
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
    limits = {"start": float(times[0]) + whole - pad, "stop": float(times[-1]) + whole + pad, "samples": 2}
    motion = other_motion(evidence, ("time", whole), lambda content: content["time"].update(limits))
    if motion is None:
        return  # the car does not go so far
    some = some_of(len(times), FEW)

    def read(shifts: Array) -> Array:
        found = [motion.at(times[some] + whole + np.clip(shift, -pad, pad)).numbers for (shift,) in shifts]
        return np.stack([numbers_in(one, looked) for one in found])

    rest = fitted(read, [0.0], 1e-4 * pad, evidence.joined(looked, some)[0])
    # Where whole instants leave nothing but rounding, there is nothing to find.
    shift = whole + (0.0 if rest is None else float(np.clip(rest.amounts[0], -pad, pad)))
    if abs(shift) <= 1e-9 * float(np.ptp(times)):
        return
    found = motion.at(times + shift).numbers
    rows: dict[Row, WouldBe] = {}
    for row in evidence.held:
        if row[1] in found[row[0]]:
            value = np.asarray(found[row[0]][row[1]])
            # The instants are rounded too, and so moves what is read there.
            speed = np.abs(np.gradient(value, times, axis=0)).max()
            # What is claimed varies along the motion: the most of it, since it is read elsewhere.
            most = np.broadcast_to(evidence.rounded(row).max(axis=0), value.shape)
            rows[row] = value, most + 8.0 * EPS * speed * (abs(shift) + np.abs(times).max())
    words = f"the same curves {abs(shift):.6g} s {'later' if shift < 0.0 else 'earlier'}"
    yield Hypothesis("shift", words, rows, 1, 2.0, whole=True)


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
