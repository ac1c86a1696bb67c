"""Faults planted into solutions: the right diagnosis comes first, and noise has none."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import cache
from itertools import cycle
from typing import Any

import numpy as np
import pytest
from changed_scenes import scene_with
from planted_faults import late, misread
from scipy.spatial.transform import Rotation

from pointcoord import Scene, simulate
from pointcoord.method import AUTO
from pointcoord.numerics.arrays import Array
from pointcoord.simulation import prepare_task, solve_task
from validate.comparison.compare import compare_solutions
from validate.diagnosis import Explanation, explain_outcome
from validate.formulations.protocol import Solution
from validate.formulations.registry import formulation
from validate.output import report
from validate.output.table import text_of
from validate.solvers.check import check

Numbers = Mapping[str, Mapping[str, Array]]
Content = dict[str, Any]

SCENES = ("double-wishbone", "off-axis-strut", "bounce")
STATES = ("position", "velocity", "acceleration")
TURNS = ("angular_velocity", "angular_acceleration")


EFFECTS = ("velocity", "acceleration", "knuckle_rates", "wheel_angles", "toe", "caster")


@cache
def solved(name: str, samples: int = 12) -> tuple[Scene, Solution]:
    scene = scene_with(name, effects=EFFECTS, samples=samples)
    return scene, formulation("pointcoord").solve(scene)


def explained(scene: Scene, held: Solution, numbers: Numbers) -> tuple[Explanation, ...]:
    """What explains a solution with these numbers of some quantities."""
    return explain_outcome(scene, compare_solutions(scene, held, held.with_numbers(numbers), "mine"))


def diagnosis(name: str, numbers: Numbers) -> tuple[Explanation, ...]:
    return explained(*solved(name), numbers)


def each(held: Solution, quantities: tuple[str, ...], change: Callable[[Array], Array]) -> Numbers:
    return {q: {name: change(array) for name, array in held.numbers[q].items()} for q in quantities}


def angle(held: Solution, name: str, change: Callable[[Array], Array]) -> Numbers:
    return {"wheel": {**held.numbers["wheel"], name: change(held.numbers["wheel"][name])}}


def arcsin(held: Solution, name: str, axis: int) -> Numbers:
    """An angle of a right wheel's spin axis by the arcsine of its component along x or z."""
    place = held.numbers["position"]
    inner = next(point for point in ("wheel_axis_inner", "strut_lower") if point in place)
    line = place["wheel_centre"] - place[inner]
    return angle(held, name, lambda _: np.arcsin(-line[:, axis] / np.linalg.norm(line, axis=1)))


def by_differences(places: Mapping[str, Array], times: Array) -> Mapping[str, Array]:
    return {n: np.gradient(p, times, axis=0) for n, p in places.items()}


def padded(places: Array, times: Array) -> Array:
    return np.concatenate([np.diff(places, axis=0) / np.diff(times)[:, None], np.zeros((1, 3))])


# The kinds of 25 more are frozen in tests/oracle.
FAULTS: list[tuple[Callable[[Solution], Numbers], str, str]] = [
    (lambda h: arcsin(h, "camber", 2), "definition", "arcsin"),
    (
        lambda h: angle(h, "toe", lambda _: np.arctan(np.sin(arcsin(h, "toe", 0)["wheel"]["toe"]))),
        "definition",
        "toe: arctan of the component of a unit vector",
    ),
    (lambda h: each(h, ("wheel",), np.tan), "definition", "kingpin, toe, caster: the slope, no angle"),
    (lambda h: each(h, ("wheel",), np.sin), "definition", "camber, kingpin, toe, caster: the sine, no angle"),
    (lambda h: angle(h, "toe", lambda v: v - v[0]), "offset", "toe: a constant offset of "),
    (lambda h: each(h, STATES, lambda v: v[:, [1, 0, 2]]), "axes", "our y, x, z"),
    (
        lambda h: {q: {**h.numbers[q], "wheel_centre": h.numbers[q]["tie_rod_outer"]} for q in STATES},
        "names",
        "of wheel_centre: the numbers of tie_rod_outer, not of wheel_centre",
    ),
    (lambda h: angle(h, "toe", lambda v: 60.0 * v), "unit", "toe: minutes of arc taken for degrees"),
    (
        lambda h: {**each(h, STATES[1:2], lambda v: v / 1e3), **each(h, STATES[2:], lambda v: v / 1e6)},
        "unit",
        "velocity, acceleration: per millisecond for per second",
    ),
    (lambda h: {"acceleration": by_differences(h.velocity, h.times)}, "differences", "central differences"),
    (
        lambda h: {"velocity": {n: padded(p, h.times) for n, p in h.position.items()}},
        "differences",
        "velocity: rates by forward differences",
    ),
    (lambda h: each(h, (*STATES, *TURNS, "wheel"), late), "sample", "caster: one sample late"),
    (
        lambda h: angle(h, "toe", lambda v: -np.roll(v, 1)),
        "sample and sign",
        "toe: one sample late, and the other sign",
    ),
    (lambda h: each(h, STATES, lambda v: v * [1.0, -1.0, 1.0] / 1e3), "sign and unit", "of y, and m for mm"),
    (
        lambda h: angle(h, "camber", lambda v: np.degrees(v) - 1.25),
        "unit and offset",
        "a constant offset of -1.25 in its own unit",
    ),
    (
        lambda h: angle(h, "camber", lambda v: np.round(np.degrees(v), 4)),
        "unit and digits",
        "degrees for radians, and printed with 4 decimals",
    ),
]


@pytest.mark.parametrize(
    ("plant", "kind", "words", "name"),
    [(*fault, name) for fault, name in zip(FAULTS, cycle(SCENES), strict=False)],
    ids=[words for *_, words in FAULTS],
)
def test_a_planted_fault_is_the_first_diagnosis(
    plant: Callable[[Solution], Numbers], kind: str, words: str, name: str
) -> None:
    numbers = plant(solved(name)[1])
    first = diagnosis(name, numbers)[0]
    assert (first.kind, first.leftover <= 1.0) == (kind, True), first
    assert words in first.words
    said = {quantity.partition(".")[0] for quantity in first.quantities}
    assert said == set(numbers)


def raised(places: Array) -> Array:
    return places + np.array([0.0, 0.0, 2.5])


@pytest.mark.parametrize(
    ("quantity", "change", "which", "words"),
    [
        ("position", raised, ("wheel_centre",), "of wheel_centre: a constant offset of (0, 0, 2.5) mm"),
        ("position", lambda v: v * [1.0, -1.0, 1.0], ("wheel_centre",), "wheel_centre: the other sign of y"),
        # It is no other origin.
        ("position", raised, "all but wheel_axis_inner", "a constant offset of (0, 0, 2.5) mm"),
        # The rack end moves along y alone: its velocity agrees either way.
        ("velocity", lambda v: v * [-1.0, 1.0, 1.0], "all", "velocity: the other sign of x"),
    ],
)
def test_what_some_points_have_is_said_of_them_and_not_of_those_that_agree(
    quantity: str, change: Callable[[Array], Array], which: str | tuple[str, ...], words: str
) -> None:
    right = solved("double-wishbone")[1].numbers[quantity]
    points = which if isinstance(which, tuple) else right.keys() - {which.removeprefix("all but ")}
    wrong = {quantity: {name: change(v) if name in points else v for name, v in right.items()}}
    first = diagnosis("double-wishbone", wrong)[0]
    said = {quantity} if which == "all" else {f"{quantity}.{name}" for name in points}
    assert ({*first.quantities}, first.leftover <= 1.0) == (said, True)
    assert words in first.words


def nearly(times: float) -> Callable[[Solution], Numbers]:
    """Off by few roundings, by a factor or a constant, so that a factor or an offset is what fits best."""
    small = times * 2.0**-53
    return lambda h: {
        **each(h, ("velocity",), lambda v: v * (1.0 + small)),
        **angle(h, "toe", lambda v: v + small * np.abs(v).max()),
    }


def noisy(size: float) -> Callable[[Array], Array]:
    random = np.random.default_rng(11)
    return lambda v: v + size * random.standard_normal(v.shape)


def nothing(v: Array) -> Array:
    return np.full_like(v, np.nan)


@pytest.mark.parametrize(
    ("places", "change", "words"),
    [
        (slice(7, 8), noisy(1.0), "disagrees at 1.27273 s only, 1 of 12 instants"),
        (slice(2, 4), nothing, "disagrees from 0.363636 s to 0.545455 s only, 2 of 12 instants"),
    ],
)
def test_an_unexplained_fault_of_a_few_instants_is_named_with_them(
    places: slice, change: Callable[[Array], Array], words: str
) -> None:
    right = solved("double-wishbone")[1].position
    wrong = right["wheel_centre"].copy()
    wrong[places] = change(wrong[places])
    (only,) = diagnosis("double-wishbone", {"position": {**right, "wheel_centre": wrong}})
    assert only.words == f"position of wheel_centre: {words}"


UNEXPLAINED: dict[str, Callable[[Solution], Numbers]] = {
    "a difference of some roundings": nearly(30.0),
    "a factor that is nearly one": lambda h: angle(h, "caster", lambda v: 0.9998905 * v),
    "a factor that leaves something": lambda h: angle(h, "caster", lambda v: noisy(1e-5)(0.97 * v)),
    "all points shaken alike": lambda h: each(h, ("position",), noisy(1e-2)),
    "zeros": lambda h: each(h, ("velocity",), lambda v: 0.0 * v),
    "a constant": lambda h: angle(h, "camber", lambda v: np.full_like(v, 0.02)),
}


@pytest.mark.parametrize("plant", UNEXPLAINED.values(), ids=UNEXPLAINED)
def test_what_tells_nothing_has_no_explanation(plant: Callable[[Solution], Numbers]) -> None:
    assert diagnosis("double-wishbone", plant(solved("double-wishbone")[1])) == ()


def over_travel(name: str) -> Scene:
    """A built-in car over its wheel's travel."""
    rest = {"rack": {"constant": 0.0}} if "rack" in Scene.load(name).inputs else {}
    laws = {"wheel_travel": {"sweep": (-45.0, 45.0)}} | rest
    # 19 instants: those of the first 18 are counted anew with other roundings.
    return scene_with(name, effects=(), inputs=laws, time={"start": 0.0, "stop": 1.0, "samples": 19})


AXLE = scene_with("axle-opposed", effects=("camber", "toe"), samples=5)


def said(scene: Scene, given: Numbers, accuracy: float = 1e-5) -> list[str]:
    return [one.words for one in check(lambda _: given, scene, accuracy=accuracy).explanations]


@pytest.mark.parametrize(
    ("scene", "amount", "coordinates", "quantities", "parts"),
    [
        # Points that stand in for others, or that an axle gives once, are misread with them.
        ("bmw-e90-strut", 5.0, "tie_rod_inner.z rack_centre.z", "wheel", "5 mm too high"),
        ("wheel-travel", 5.0, "tie_rod_inner.z rack_centre.z", f"{' '.join(STATES)} wheel", "5 mm too high"),
        (
            AXLE,
            3.0,
            "left.tie_rod_outer.x right.tie_rod_outer.x",
            "position wheel",
            "3 mm too far back: -117",
        ),
        (
            AXLE,
            -1.5,
            "left.tie_rod_outer.y -right.tie_rod_outer.y",
            "position wheel",
            "1.5 mm too far out: -651.5",
        ),
        # Out is the side of the wheel that a point belongs to.
        (AXLE, 1.5, "right.tie_rod_outer.y", "position", "1.5 mm too far out: 651.5, not 650"),
    ],
)
def test_what_is_misread_is_said_and_nothing_else(
    scene: str | Scene, amount: float, coordinates: str, quantities: str, parts: str
) -> None:
    car = scene if isinstance(scene, Scene) else scene_with(scene, effects=EFFECTS, samples=12)
    first, *others = coordinates.split()
    numbers = misread(car, amount, first, *others)
    (found,) = said(car, {quantity: numbers[quantity] for quantity in quantities.split()})
    assert f"{first} seems {parts}" in found
    assert all(found.endswith(f"and {other.rpartition('.')[0].strip('-')} with it") for other in others)


def test_an_offset_of_one_wheel_hides_no_misread_hardpoint_of_the_other() -> None:
    """Two hardpoints would do as well, were it not for angles that agree."""
    wheel = misread(AXLE, -1.0, "right.lower_arm_front.z")["wheel"]
    found = said(AXLE, {"wheel": {**wheel, "left.camber": wheel["left.camber"] - 0.01}})
    assert any("right.lower_arm_front.z seems 1 mm too low" in one for one in found)
    assert "left.camber: a constant offset of -0.01 rad" in found
    assert not any(" and left." in one for one in found)


def test_displacements_from_the_drawing_are_said_to_be_of_all_points() -> None:
    """The motion does not start at the drawing, and points at rest have the same fault as the others."""
    scene = over_travel("hmmwv-front")
    drawn = scene.mechanism.points
    given = {name: place - drawn[name] for name, place in simulate(scene).numbers["position"].items()}
    assert said(scene, {"position": given}) == ["position: the value of the drawing is subtracted"]


def test_a_misread_point_of_a_body_is_no_other_assembly_and_what_else_is_wrong_is_said_too() -> None:
    """No link holds this point, and so its lengths in other assemblies are those of its body."""
    numbers = misread(solved(SCENES[0])[0], 5.0, "wheel_centre.x")
    degrees = {"wheel": {n: np.degrees(a) for n, a in numbers["wheel"].items()}}
    first, second, *_ = diagnosis(SCENES[0], {**numbers, **degrees})
    assert (first.kind, second.kind) == ("hardpoint", "unit")
    assert "wheel_centre.x seems 5 mm too far back" in first.words
    assert "degrees for radians" in second.words


@pytest.mark.parametrize(
    ("name", "rod", "quantities", "told"),
    [
        ("five-link", "lower_rear", (), "lower_rear is 2 mm too short: 375.492 mm, not 377.492"),
        ("off-axis-strut", "tie_rod", ("position",), "tie_rod is 2 mm too short"),
    ],
)
def test_a_rod_of_another_length_is_named_with_what_it_is_too_long(
    name: str, rod: str, quantities: tuple[str, ...], told: str
) -> None:
    """By the absolute model, of a car in which the distance of the rod's ends is driven instead."""
    scene = scene_with(name, effects=("velocity", "acceleration", "camber", "toe"), samples=21)
    plain = scene.mechanism.plain(tuple(scene.inputs))
    part: Content = {
        key: plain[key] for key in ("side", "points", "bodies", "rods", "slides", "inputs", "roles")
    }
    ends = part["rods"].pop(rod)
    part["inputs"] |= {"its_length": {"distance": ends}}
    drawn = float(np.linalg.norm(np.subtract(*(part["points"][end] for end in ends))))
    content = scene.model_dump(exclude_none=True) | {"mechanism": part}
    content["inputs"] |= {"its_length": {"constant": drawn - 2.0}}
    numbers = formulation("absolute").solve(Scene.from_mapping(content, "another car")).numbers
    held = formulation("pointcoord").solve(scene)
    given = replace(held, numbers={quantity: numbers[quantity] for quantity in quantities or numbers})
    first, *others = explain_outcome(scene, compare_solutions(scene, held, given, "car"))
    assert (first.kind, first.leftover <= 1.0) == ("link", True)
    assert told in first.words
    # The end of a tie rod on a rack may be misread instead, along the rack: the same links.
    assert all("tie_rod_inner.y seems" in other.words for other in others)
    assert not (others and name == "five-link")


def test_what_is_wrong_by_a_few_tolerances_is_said_with_what_is_clearly_wrong() -> None:
    scene, _ = solved("double-wishbone")
    given = {"wheel": misread(scene, 1.0, "upper_ball_joint.y")["wheel"]}
    shares = {
        row.name: row.share for row in check(lambda _: given, scene, 1e-4).rows if row.quantity == "wheel"
    }
    # What a number may be off by goes with the accuracy.
    least = min(shares, key=lambda name: shares[name])
    (first,) = check(lambda _: given, scene, 1e-4 * shares[least] / 2.5).explanations
    assert "upper_ball_joint.y seems 1 mm too far" in first.words
    assert {*first.quantities} == {f"wheel.{name}" for name in shares}


def test_the_proven_side_is_the_trusted_one() -> None:
    scene, held = solved("double-wishbone")
    guess = replace(
        held.with_numbers(angle(held, "camber", np.degrees)), accuracy=replace(held.accuracy, proven=False)
    )
    outcome = compare_solutions(scene, guess, held, "other way round")
    assert "degrees for radians" in explain_outcome(scene, outcome)[0].words


def test_the_program_prints_at_most_three_and_writes_all_of_them() -> None:
    scene, held = solved("double-wishbone")
    given = held.with_numbers(angle(held, "camber", np.degrees))
    outcome = compare_solutions(scene, held, given, "degrees")
    outcome = replace(outcome, explanations=explain_outcome(scene, outcome) * 5)
    text = text_of(report.outcome_parts(outcome))
    assert text.count("possible explanation: ") == 3
    assert text.splitlines()[-1].endswith("camber: degrees for radians")
    assert len(report.outcome_data(outcome)["explanations"]) == 5


def rack(times: float, more: float = 0.0) -> dict[str, object]:
    """A law that is a sum, taken as k x + m."""
    sine = {"amplitude": 10.0 * times, "angular_frequency": 3.0}
    return {"sum": [{"sine": sine}, {"constant": 4.0 * times + more}]}


@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        ({"rack": rack(20.0 / 21.0)}, "the input rack is taken 0.952381 times"),
        ({"rack": rack(0.0)}, "the input rack is taken as 0"),
        ({"rack": rack(1.0, 5.0)}, "the input rack is taken 5 mm more"),
        ({"arm_angle": {"polynomial": [1.57, 0.2]}}, "the input arm_angle is taken 0.02 rad more"),
    ],
)
def test_inputs_that_are_taken_otherwise_are_the_first_diagnosis_and_the_only_one(
    wrong: dict[str, object], words: str
) -> None:
    laws = {"arm_angle": {"polynomial": [1.55, 0.2]}, "rack": rack(1.0)}
    scene, other = (
        scene_with("double-wishbone", effects=EFFECTS, samples=12, inputs=laws | changed)
        for changed in ({}, wrong)
    )
    held, found = (formulation("pointcoord").solve(one) for one in (scene, other))
    (first,) = explained(scene, held, found.numbers)
    assert (first.kind, first.leftover <= 1.0) == ("input", True)
    assert first.words.endswith(f": {words}")
    assert {*STATES} <= {q.partition(".")[0] for q in first.quantities}


def test_another_assembly_of_the_same_links_is_told_as_one() -> None:
    # The tie rod's other side: its outer end mirrored in the plane of its inner end and the kingpin keeps all
    # three distances, and the knuckle's other points turn about the kingpin with it.
    scene = scene_with("double-wishbone", effects=(*EFFECTS, "wheel_travel"), samples=12)
    held = formulation("pointcoord").solve(scene)
    points = {name: np.array(place) for name, place in scene.mechanism.points.items()}
    low, centre = points["lower_ball_joint"], points["wheel_centre"]
    top, inner, outer = (points[n] - low for n in ("upper_ball_joint", "tie_rod_inner", "tie_rod_outer"))
    normal = np.cross(top, inner)
    other = outer - 2.0 * (outer @ normal) / (normal @ normal) * normal
    turn, _ = Rotation.align_vectors([top, other], [top, outer])
    for name in ("tie_rod_outer", "wheel_centre", "wheel_axis_inner"):
        points[name] = low + turn.apply(points[name] - low)
    drawn = {name: tuple(place.tolist()) for name, place in points.items()}
    part = scene.mechanism.model_copy(update={"points": drawn})
    motion = solve_task(prepare_task(scene.model_copy(update={"mechanism": part, "tolerance": 1e-13}), AUTO))
    # The travels count from the drawing, not from its other assembly.
    travel = motion.numbers["dimension"]["travel"] + points["wheel_centre"][2] - centre[2]
    given = replace(held, numbers={**motion.numbers, "dimension": {"travel": travel}})
    (found,) = explain_outcome(scene, compare_solutions(scene, held, given, "double-wishbone"))
    assert (found.kind, found.leftover <= 1.0) == ("branch", True), found
