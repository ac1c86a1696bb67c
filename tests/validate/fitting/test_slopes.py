"""The slopes that a fit goes by, held to differences of solved designs.

Differences D(h) of designs h to either side lack terms of h^2. R(h) = (4 D(h) - D(2 h)) / 3 lacks terms of
h^4, of which R(2 h) has sixteen times as many: what R(h) lacks is below |R(h) - R(2 h)|. Numbers that are off
by b make it off by (4 / 3 + 1 / 6) b / h at most.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from itertools import pairwise

import numpy as np
import pytest
from curve_files import measured
from numpy.typing import NDArray

from pointcoord import Scene, designs_of, simulate, sweep
from pointcoord.effects.registry import EFFECTS
from validate.fitting.curves import Curves
from validate.fitting.fit import free_coordinates
from validate.fitting.slopes import CarSlopes
from validate.formulations.input_rates import rates

Array = NDArray[np.float64]

STEP = 0.1  # mm
EPS = float(np.finfo(float).eps)
MULTIPLES = np.array([1.0, 2.0, 4.0])
SCENES = ("double-wishbone", "bounce", "off-axis-strut", "bounce-on-a-heaving-chassis")


def richardson(read: Callable[[float], Array]) -> tuple[Array, Array]:
    """R(h) and what it may lack beside rounding, of numbers by how far a coordinate is moved."""
    differences = [(read(m * STEP) - read(-m * STEP)) / (2.0 * m * STEP) for m in MULTIPLES.tolist()]
    fine, coarse = ((4.0 * a - b) / 3.0 for a, b in pairwise(differences))
    return fine, np.abs(fine - coarse)


def with_every_effect(name: str) -> Scene:
    scene = Scene.load(name)
    content = scene.model_dump(exclude_none=True) | {
        "effects": tuple(EFFECTS),
        "time": {"start": 0.0, "stop": scene.time.stop, "samples": 4},
        "tolerance": 1e-11,
    }
    return Scene.from_mapping(content, name)


@pytest.mark.parametrize("name", SCENES)
def test_slopes_of_every_number_by_every_coordinate_are_those_of_moved_cars(name: str) -> None:
    scene = with_every_effect(name)
    every = dict.fromkeys((f"{p}.{a}" for p in scene.mechanism.topology.required_points for a in "xyz"), 0.0)
    going = designs_of(scene, offsets=every).following
    free = free_coordinates(scene, [p for p in scene.mechanism.points if p not in going])
    moves = Curves(scene, measured("time [s],wheel.camber [rad]\n0,0\n", scene), free).moves
    motion = simulate(scene)
    laws = {name: rates(law, motion.times) for name, law in scene.inputs.items()}
    found, _ = CarSlopes(scene, moves).at(motion.numbers["position"], laws, motion.numbers)
    amounts = np.concatenate([[m * STEP, -m * STEP] for m in MULTIPLES.tolist()])
    moved = np.concatenate([np.outer(amounts, row) for row in np.eye(len(free))])
    swept = sweep(scene, offsets={coordinate: moved[:, i] for i, coordinate in enumerate(free)})
    assert swept.solved.all()
    # All of the car as drawn, but for millimetres: what is proven of some holds of the others.
    proofs = [swept.proof(number, rates=True).proven for number in (0, len(moved) // 2, len(moved) - 1)]
    size = float(np.abs([*scene.mechanism.points.values()]).max())
    for quantity, part in motion.numbers.items():
        for one in part:
            own = np.asarray(swept.numbers[quantity][one])
            bound = max(float(np.max(p[quantity][one])) for p in proofs) + EPS * float(np.abs(own).max())
            for i, coordinate in enumerate(free):
                block = own[len(amounts) * i : len(amounts) * (i + 1)]
                told = dict(zip(amounts.tolist(), block, strict=True))
                slope, lacking = richardson(lambda move, told=told: told[move])
                apart = np.abs(found[quantity][one][i] - slope)
                # The moved coordinate is rounded as well.
                off = bound + EPS * size * float(np.abs(slope).max())
                allowed = lacking + 1.5 * off / STEP
                assert (apart <= allowed).all(), (quantity, one, coordinate, (apart / allowed).max())
                assert allowed.max() < 1e-4 * max(1.0, np.abs(slope).max()), (quantity, one, coordinate)


def beside_its_rack() -> Scene:
    """A double wishbone whose tie rod is drawn 12 mm along the rack: its own travel is a coordinate's."""
    content = Scene.load("double-wishbone").model_dump(exclude_none=True)
    points = dict(content["mechanism"]["points"])
    x, y, z = points["tie_rod_inner"]
    points["rack_centre"] = (x, y + 12.0, z)
    mechanism = content["mechanism"] | {"points": points}
    return Scene.from_mapping(
        content | {"mechanism": mechanism, "effects": ("wheel_angles", "toe"), "tolerance": 1e-11}, "rack"
    )


TRAVELS = "\n".join(f"{t:g},0,0,0" for t in np.linspace(-30.0, 25.0, 3))
ANGLES = "\n".join(f"{a:g},{r:g},0,0" for a, r in ((1.45, -10), (1.5, 0), (1.55, 12), (1.6, 5)))
NUMBERS = "wheel.camber [deg],wheel.toe [deg]"
COLUMNS: Mapping[str, tuple[str, Mapping[str, object]]] = {
    "travel, the rack as drawn": (
        f"travel.wheel_centre [mm],{NUMBERS},position.tie_rod_outer.x [mm]\n{TRAVELS}",
        {},
    ),
    "travel of the tyre's contact, the rack held": (
        f"travel.contact [mm],{NUMBERS},position.wheel_centre.y [mm]\n{TRAVELS}",
        {"rolling_radius": 270.0, "held": {"rack": 5.0}},
    ),
    "rack, the arm as drawn": (
        f"input.rack [mm],{NUMBERS},position.tie_rod_outer.x [mm]\n{TRAVELS}",
        {},
    ),
    "rack at one travel": (
        f"input.rack [mm],{NUMBERS},position.tie_rod_outer.x [mm]\n{TRAVELS}",
        {"held": {"travel.wheel_centre": 10.0}},
    ),
    "angle and rack, an angle by its arcsine": (
        f"input.arm_angle [rad],input.rack [mm],{NUMBERS}\n{ANGLES}",
        {"columns": {name.partition(" ")[0]: {"definition": "arcsine"} for name in NUMBERS.split(",")}},
    ),
}
MOVED = ("lower_ball_joint.z", "tie_rod_inner.y", "wheel_centre.y")


@pytest.mark.parametrize("over", COLUMNS)
def test_slopes_over_travels_racks_and_angles_are_those_of_moved_cars(over: str) -> None:
    text, content = COLUMNS[over]
    scene = beside_its_rack()
    curves = Curves(scene, measured(text, scene, **content), MOVED)
    zero = np.zeros(len(MOVED))
    start = curves.solved(zero)
    used = np.ones(len(start.numbers), dtype=bool)
    assert start.found.reached.all()
    found = start.slopes(used)
    # Poses keep a tolerance of 1e-11 mm, and so do travels; no number is off by more than ten times that.
    off = 1e-10
    for i, coordinate in enumerate(MOVED):
        slope, lacking = richardson(lambda move, i=i: curves.at(zero + move * np.eye(len(MOVED))[i]))
        allowed = lacking + 1.5 * off / STEP
        assert (np.abs(found[:, i] - slope) <= allowed).all(), (
            coordinate,
            float((np.abs(found[:, i] - slope) / allowed).max()),
        )
        assert allowed.max() < 1e-5
    if "as drawn" in over:
        # What is as drawn goes along with the drawing: no slope at a held input.
        assert np.abs(found[:, MOVED.index("tie_rod_inner.y")]).max() > 1e-4
