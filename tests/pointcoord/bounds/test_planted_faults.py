"""A proof is tested by making it lie: without one of its terms some number is outside its bound."""

from __future__ import annotations
import __future__

import inspect
import textwrap
from collections.abc import Callable
from fractions import Fraction
from functools import cache
from types import FunctionType, SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from changed_scenes import scene_with
from every_number import every_effect
from many_digits import fractions

from pointcoord import simulate
from pointcoord.bounds import certified_poses, enclosed_points
from pointcoord.bounds.certified_poses import CertifiedPoses, grouped, with_known
from pointcoord.bounds.enclosed_points import EnclosedPoses, enclosed_coordinates
from pointcoord.effects import corner, knuckle_rates
from pointcoord.effects.point_states import STATES
from pointcoord.effects.registry import QUANTITIES
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.numerics import enclosed_rows, enclosure, kantorovich
from pointcoord.numerics.arrays import Array
from pointcoord.numerics.enclosure import Enclosed
from pointcoord.numerics.quadratic import Product, quadratic_map
from pointcoord.results import proof
from validate.formulations.reference_solution import inputs_at, reference_instant
from validate.reference.exact import as_fraction

# u u + 2 u p = q: one unknown, whose error counts by its square, and two known numbers.
UNKNOWN, ZERO, ONE, P, Q = range(5)
SYSTEM = quadratic_map(
    [
        (
            Product(1.0, (UNKNOWN, ZERO), (UNKNOWN, ZERO)),
            Product(2.0, (UNKNOWN, ZERO), (P, ZERO)),
            Product(-1.0, (Q, ZERO), (ONE, ZERO)),
        )
    ],
    1,
    5,
)
TOY = cast(Mechanism, SimpleNamespace(map=SYSTEM, drawn_lacks=np.zeros(5), drawn_doubt=np.zeros(5)))
COUNT = 256
# By how much of itself a number is computed wrongly, what p has below its last digit, the doubt of p and q;
# poses lie apart.
CASES = [
    (off, rest, doubt, apart)
    for off in (0.0, 2.0**-30, 2.0**-6)
    for rest in (0.0, 2.0**-60)
    for doubt in (0.0, 2.0**-24, 2.0**-5)
    for apart in (0.0, 2.0**-8)
]


def toy_holds(off: float, rest: float, doubt: float, apart: float) -> bool:
    """Whether u, u' and u'' lie within their radii where p and q are what they are at their doubt's ends.

    All numbers have so few bits that their products are exact; p has its `rest` more, and q what that makes.
    """
    rng = np.random.default_rng(5)

    def numbers(low: int, high: int) -> Array:
        same = (
            np.full(COUNT, rng.integers(low, high) / 2.0**8)
            if apart
            else rng.integers(low, high, COUNT) / 2.0**8
        )
        return np.asarray(same + apart * np.linspace(0.0, 1.0, COUNT, endpoint=False))

    (u, u1, u2), (p, p1, p2) = ([numbers(256, 1024) for _ in range(3)] for _ in range(2))
    q = (
        u * u + 2.0 * u * p,
        2.0 * (u * u1 + u1 * p + u * p1),
        2.0 * (u1 * u1 + u * u2 + u2 * p + 2.0 * u1 * p1 + u * p2),
    )

    def signs() -> Array:
        return rng.choice([-1.0, 1.0], COUNT)

    states, driven, doubts = [], [], doubt * rng.choice([0.25, 1.0], COUNT)
    for d, (unknown, *known) in enumerate(zip((u, u1, u2), (p, p1, p2), q, strict=True)):
        state = np.zeros((COUNT, 5))
        state[:, UNKNOWN] = unknown * (1.0 + off * signs())
        enclosed, rests = {}, (rest if d == 0 else 0.0, 2.0 * unknown * rest)
        for place, exact, low in zip((P, Q), known, rests, strict=True):
            # Rates are known less well, so that their own doubt is what counts.
            given = exact + 16.0**d * doubts * signs()
            enclosed[place] = Enclosed.of(given, low, 16.0**d * doubts, 0.0)
            state[:, place] = given
        states.append(state)
        driven.append(enclosed)
    states[0][:, ONE] = 1.0
    with np.errstate(all="ignore"):
        groups, factors = grouped(SYSTEM, states[0], (P, Q))
        together = groups.together
        parts = [
            {place: number.together(together) for place, number in enclosed.items()} for enclosed in driven
        ]
        poses = CertifiedPoses.of(TOY, groups, factors, together(states[0]), parts[0])
        rates = [
            with_known(together(state), 1, known) for state, known in zip(states[1:], parts[1:], strict=True)
        ]
        found = enclosed_coordinates(TOY, poses, rates, np.zeros((len(poses.factors.condition), 1)), ())
    within = [_within(state, exact, poses) for state, exact in zip(found, (u, u1, u2), strict=True)]
    return all(within)


def _within(state: Enclosed, exact: Array, poses: CertifiedPoses) -> bool:
    *parts, radius = (
        poses.groups.apart(np.broadcast_to(part, state.change.shape))[:, UNKNOWN]
        for part in (state.high, state.low, state.change, state.radius[0])
    )
    known = np.isfinite(radius)
    off = np.abs(fractions(exact[known]) - sum(fractions(part[known]) for part in parts))
    return bool((off <= fractions(radius[known])).all())


def scene_holds(name: str) -> bool:
    """Whether every number of a scene is off by its bound at most, and that by what is expected at most."""
    motion, references = solved(name)
    samples = motion.at(np.array([instant for instant, _ in references]))
    found = motion.proof_of(samples, rates=True)
    for k, (_, exact) in enumerate(references):
        numbers = {**exact.effects, **exact.rod_force, **exact.hinge_thrust}
        of_the_car = {key: [value] for key, value in numbers.items()}
        states = dict(zip(STATES, exact.derivatives, strict=False))
        for quantity, channel in samples.numbers.items():
            of_a_body = {} if quantity in states else vars(exact).get(quantity, {})
            own = of_the_car if QUANTITIES[quantity].of == "car" else states.get(quantity, of_a_body)
            for part, values in channel.items():
                kept = values, found.proven[quantity][part], found.expected[quantity][part]
                reported, bounds, expected = (np.atleast_1d(array[k]).tolist() for array in kept)
                for value, bound, most, x in zip(reported, bounds, expected, own[part], strict=True):
                    # A double less a fraction would be rounded to a double: both are made fractions.
                    # The reference has 60 digits, and a proof rounds by some u^2.
                    right = as_fraction(x, part)
                    off = abs(Fraction(value) - right) - Fraction(1, 10**50) * (1 + abs(right))
                    if not off <= bound <= most + 1e-24:
                        return False
    return True


SCENES = ("bounce-on-a-heaving-chassis", "off-axis-strut")
# Numbers of derivatives by inputs, by lengths of rods and by gaps of joints.
ALONG_WAYS = "double-wishbone"
BY_WAYS = ["camber_by_travel", "toe_by_rack", "roll_centre", "screw_axis", "loads"]
LOAD = {"force": [300.0, -500.0, 3000.0], "moment": [0.0, 2e4, 0.0]}


@cache
def solved(name: str) -> Any:
    """A motion with all effects, or with some along ways, and the reference at a few of its instants."""
    along = name == ALONG_WAYS
    scene = scene_with(name, {"loads": {"": LOAD}}, effects=BY_WAYS) if along else every_effect(name)
    motion = simulate(scene)
    instants = motion.times[[3, 40, -9]].tolist()
    return motion, [(t, reference_instant(scene, inputs_at(scene, t))) for t in instants]


FAULTS: list[tuple[Callable[..., Any], str, str]] = [
    (kantorovich.smallest_radius, "least = 2.0 * eta", "least = eta"),
    (kantorovich.ball, "(z * radius + 0.5 * omega * radius**2)", "(z * radius)"),
    (kantorovich.ball, "(z * radius + 0.5 * omega * radius**2)", "(0.5 * omega * radius**2)"),
    (kantorovich.ball, "(z + omega * radius)", "(0.9 * omega * radius)"),
    (kantorovich.certify, "uncertainty = rows.radius[0] +", "uncertainty = 0.5 * rows.radius[0] +"),
    (kantorovich.certify, "np.abs(step) + spread", "np.abs(step)"),
    (kantorovich.defect_of, "data + pose.reach", "data"),
    (kantorovich.defect_of, "data + pose.reach", "pose.reach"),
    (enclosed_points._tail, "0.5 * magnitude", "0.25 * magnitude"),
    (enclosed_points._tail, "certificate.defect + bent", "bent"),
    (enclosed_points._tail, "known + tail", "tail"),
    (enclosed_coordinates, "spread + _tail", "_tail"),
    (enclosed_coordinates, "-certificate.step", "0.0 * certificate.step"),
    (enclosed_coordinates, "range(1, order // 2 + 1)", "range(2, order // 2 + 1)"),
    (enclosed_coordinates, "comb(order, i) //", "2 //"),
    (enclosed_coordinates, "largest + proven", "proven"),
    (enclosed_coordinates, "certificate.defect + magnitude", "magnitude"),
    (enclosed_points._corrected, "rest.radius[0, :, 0] +", "0.5 * rest.radius[0, :, 0] +"),
    (enclosed_points._corrected, "proven + tail", "proven"),
    (enclosed_points._moved, "change[..., :n] += step.change", "pass"),
    (certified_poses.with_known, "np.broadcast_to(lacks, high.shape)", "0.0 * high"),
    (enclosed_rows.twice_polar, ".scaled(2.0)", ""),
    (enclosed_rows.twice_polar, " + b[0] * a[1]", ""),
    (Enclosed._sum, "mine + its", "0.5 * (mine + its)"),
    (Enclosed.__mul__, "self.high * other.low", "0.0 * other.low"),
    (Enclosed.__mul__, "self.low * other.high", "0.0 * self.low"),
    (Enclosed.__mul__, "self.size * its", "0.5 * self.size * its"),
    (Enclosed.__mul__, "mine * (its_size + its)", "0.5 * mine * its_size"),
    (Enclosed.__mul__, "other.high + other.change", "other.high + 0.0 * other.change"),
    (Enclosed.__mul__, "change += self.high * other.change", "pass"),
    (Enclosed.together, ".max(axis=1", ".min(axis=1"),
    (enclosed_points._normals, ".times(comb(order, i))", ""),
    (enclosed_points._normals, ".times(comb(order, i))", ".times(min(comb(order, i), 2))"),
    (enclosed_points._normals, "range(order + 1)", "range(max(order, 1))"),
    (enclosed_points._carried, " + c * crossed", ""),
    (EnclosedPoses.reported, " + self.added[derivative]", ""),
    (knuckle_rates.body_rate_error, "s - cross(pull, cross(pull, edge))", "s"),
    (corner.turn_of_edges, "along + across", "along"),
    (enclosure.angle_error, "sine * c - cosine * s", "sine * c"),
]
FAULTS_ALONG_WAYS: list[tuple[Callable[..., Any], str, str]] = [
    (proof._slopes, "drive.input == driven", "drive.input != driven"),
    (enclosed_coordinates, "beside.scaled(opened[1])", "beside.scaled(0.5 * opened[1])"),
    (corner.turning_of, "times(c, normal.slope)", "times(c + c, normal.slope)"),
    (enclosure.quotient, "off / left", "0.0 * off / left"),
]


def lies(function: Callable[..., Any], old: str, new: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Plant a fault in the source of a function, wherever it is used."""
    source = textwrap.dedent(inspect.getsource(function))
    assert old in source, old
    made: dict[str, Any] = {}
    flags = __future__.annotations.compiler_flag
    assert isinstance(function, FunctionType)
    exec(
        compile(source.replace(old, new), function.__code__.co_filename, "exec", flags),
        function.__globals__,
        made,
    )
    monkeypatch.setattr(function, "__code__", made[function.__name__].__code__)


def all_holds() -> bool:
    return all(toy_holds(*case) for case in CASES) and all(map(scene_holds, SCENES))


def ways_hold() -> bool:
    return scene_holds(ALONG_WAYS)


def test_every_number_lies_within_its_bound() -> None:
    assert all_holds()
    assert ways_hold()


@pytest.mark.parametrize(
    ("holds", "function", "old", "new"),
    [*((all_holds, *fault) for fault in FAULTS), *((ways_hold, *fault) for fault in FAULTS_ALONG_WAYS)],
)
def test_a_proof_without_one_of_its_terms_is_found_out(
    holds: Callable[[], bool],
    function: Callable[..., Any],
    old: str,
    new: str,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    for name in (*SCENES, ALONG_WAYS):
        solved(name)  # before the fault is planted
    lies(function, old, new, monkeypatch)
    assert not holds()
