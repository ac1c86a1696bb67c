"""Random cars and motions for property-based tests, built so that most of them can be assembled.

Hardpoints move by up to two hundred millimetres in every coordinate from the paper's, which changes link
lengths and proportions by half; the strut's two inner points stay near the line of its outer two, as
they do in any drawing of a strut, but not on it: its two halves are bent by up to 8 degrees each, as in
the paper's own Table 1.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from hypothesis import strategies as st
from numpy.typing import NDArray

from pointcoord import Scene
from validate.paper_car import EFFECTS, FREE, PAPER, Points, mirrored

Array = NDArray[np.float64]


def _floats(reach: float) -> st.SearchStrategy[float]:
    return st.floats(-reach, reach, allow_nan=False, allow_subnormal=False)


def _vectors(reach: float) -> st.SearchStrategy[Array]:
    return st.tuples(_floats(reach), _floats(reach), _floats(reach)).map(np.array)


@st.composite
def hardpoints(draw: st.DrawFn, reach: float = 200.0) -> Points:
    """Points of a random left-hand strut, each free coordinate up to `reach` mm from the paper's."""
    points = {name: np.array(PAPER[name]) + draw(_vectors(reach)) for name in FREE}
    top, ball = points["strut_top"], points["lower_ball_joint"]
    length = float(np.linalg.norm(ball - top))
    for name, low, high in (("strut_lower", 0.55, 0.95), ("strut_rod_end", 0.2, 0.5)):
        place = draw(st.floats(low, high))
        nearer = min(place, 1.0 - place) * length
        points[name] = top + place * (ball - top) + 0.08 * nearer * draw(_vectors(1.0))
    points["tie_rod_inner"] = points["rack_centre"] + draw(_vectors(5.0))
    return {name: _triple(points[name]) for name in PAPER}


def _triple(vector: Array) -> tuple[float, float, float]:
    x, y, z = (float(component) for component in vector)
    return x, y, z


@st.composite
def scenes(draw: st.DrawFn, reach: float = 200.0, samples: int = 5) -> Scene:
    """A random car, on either side, with random inputs and rates about its own drawing.

    The arm turns and the rack slides by polynomials or sines, and the chassis may heave. Whether the
    mechanism can follow is not known beforehand.
    """
    points = draw(hardpoints(reach))
    side = draw(st.sampled_from(["left", "right"]))
    if side == "right":
        points = mirrored(points)
    arm = np.subtract(points["lower_ball_joint"], points["lower_arm_front"])
    drawn_angle = math.acos(arm[2] / float(np.linalg.norm(arm)))
    inputs: dict[str, Any] = {
        "arm_angle": draw(_law(drawn_angle, 0.25, 0.6)),
        "rack": draw(_law(0.0, 20.0, 60.0)),
    }
    if draw(st.booleans()):
        inputs["heave"] = draw(_law(0.0, 30.0, 200.0))
    return make_scene(
        points, inputs, side=side, stop=draw(st.sampled_from([0.05, 0.2, 0.5])), samples=samples
    )


@st.composite
def _law(draw: st.DrawFn, middle: float, reach: float, rate: float) -> dict[str, Any]:
    offset = middle + draw(_floats(reach))
    if draw(st.booleans()):
        return {"polynomial": [offset, draw(_floats(rate)), draw(_floats(rate))]}
    speed = draw(st.floats(0.5, 8.0))
    wave = {"amplitude": draw(_floats(rate)) / speed, "angular_frequency": speed}
    return {"sine": {**wave, "phase": draw(_floats(3.0)), "offset": offset}}


def make_scene(
    points: Points,
    inputs: dict[str, Any],
    *,
    side: str = "left",
    up: tuple[float, float, float] = (0.0, 0.0, 1.0),
    right: tuple[float, float, float] = (0.0, 1.0, 0.0),
    stop: float = 0.2,
    samples: int = 5,
    tolerance: float = 1e-9,
    effects: tuple[str, ...] = EFFECTS,
) -> Scene:
    """A scene from plain data, checked like a file."""
    return Scene.from_mapping(
        {
            "title": "random scene",
            "effects": list(effects),
            "tolerance": tolerance,
            "mechanism": {
                "type": "macpherson",
                "closure": "collinear",
                "side": side,
                "up": list(up),
                "right": list(right),
                "points": {name: list(point) for name, point in points.items()},
            },
            "inputs": inputs,
            "time": {"start": 0.0, "stop": stop, "samples": samples},
        }
    )
