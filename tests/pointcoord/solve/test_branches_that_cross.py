"""Parallelograms whose cranks pass the pose where all of them lie in one line, in closed form.

There the assembly of parallel cranks crosses those of crossed ones. A motion that passes it is refused there,
and so is one that ends on it or touches it; one that comes near and turns back is answered.
"""

from typing import Any

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from pointcoord import AssemblyError, MotionNotMapped, Scene, simulate
from pointcoord.numerics.arrays import Array
from pointcoord.results.motion import Motion

CRANK = 1000.0
DENSE, AT_INSTANTS = ("series", "map"), ("newton", "newton-cold", "chord")
by_method = pytest.mark.parametrize("method", [*DENSE, *AT_INSTANTS])
by_solver = pytest.mark.parametrize("method", ["series", *AT_INSTANTS])
few = settings(deadline=None, max_examples=max(3, settings.default.max_examples // 35))
loops, grounds = st.integers(1, 3), st.sampled_from([700.0, 1000.0, 1400.0])


def linkage(count: int, ground: float, drawn: float, law: dict[str, Any], across: bool = False) -> Scene:
    """Cranks in a row, each pair joined by a rod as long as they stand apart.

    Args:
        count: of parallelograms. drawn: angle of the cranks, rad.
        across: whether the distance of the first crank's pin to a point beside the last crank drives them,
            which makes all loops one block; or the first crank's turn, and each loop is a block.
    """
    reach = CRANK * np.array([np.cos(drawn), np.sin(drawn), 0.0])
    places, bodies = {}, {"chassis": list[str]()}
    for k in range(count + 1):
        foot = np.array([ground * k, 0.0, 0.0])
        places |= {f"A{k}": foot, f"A{k}_pin": foot + np.array([0.0, 0.0, 1000.0]), f"B{k}": foot + reach}
        bodies["chassis"] += [f"A{k}", f"A{k}_pin"]
        bodies[f"crank_{k}"] = [f"A{k}", f"A{k}_pin", f"B{k}"]
    driven: dict[str, Any] = {"angle": "crank_0", "from": "drawing"}
    if across:
        places["E"] = np.array([ground * count - 0.6 * reach[1], 0.6 * reach[0], 0.0])
        bodies[f"crank_{count}"].append("E")
        driven = {"distance": ["B0", "E"]}
    mechanism = {
        "bodies": bodies,
        "rods": {f"coupler_{k}": [f"B{k - 1}", f"B{k}"] for k in range(1, count + 1)},
        "inputs": {"crank": driven},
        "points": {name: place.tolist() for name, place in places.items()},
    }
    content = {
        "title": "parallelograms",
        "effects": ["velocity"],
        "tolerance": 1e-6,
        "mechanism": mechanism,
        "inputs": {"crank": law},
        "time": {"start": 0.0, "stop": 1.0, "samples": 9},
    }
    return Scene.from_mapping(content, "parallelograms")


def tried(scene: Scene, method: str) -> tuple[Motion | None, str]:
    """As much of the motion as there is, and why not more."""
    try:
        return simulate(scene, method), ""
    except (AssemblyError, MotionNotMapped) as error:
        return error.partial, str(error)


def off(motion: Motion, count: int, ground: float, angles: Array) -> float:
    """How far any pin is from where parallel cranks have it, mm."""
    return max(
        float(np.abs(motion.position[f"B{k}"][:, :2] - np.stack([x, y], axis=-1)).max())
        for k in range(count + 1)
        for x, y in [(ground * k + CRANK * np.cos(angles), CRANK * np.sin(angles))]
    )


@by_method
@settings(few, max_examples=few.max_examples + 1)
@given(
    count=loops,
    ground=grounds,
    drawn=st.floats(0.5, 2.5),
    beyond=st.sampled_from([0.0, 1e-3, 0.05, 0.5, 2.5]),
    back=st.booleans(),
)
@example(count=2, ground=1400.0, drawn=np.pi / 2, beyond=1.5 * np.pi, back=False)
# With 16 quarter turns in nine instants every one after the first is drawn as it was, half a turn further,
# and two lines are passed from one to the next.
@example(count=3, ground=1000.0, drawn=np.pi / 2, beyond=7.5 * np.pi, back=False)
def test_cranks_that_pass_the_line_or_touch_it_are_refused_there(
    method: str, count: int, ground: float, drawn: float, beyond: float, back: bool
) -> None:
    """They end there or beyond, or turn back; what lies before is right, and nothing else is answered."""
    way, short = np.pi - drawn + beyond, np.pi - drawn
    law = np.polynomial.Polynomial([0.0, 4.0 * way, -4.0 * way] if back else [0.0, way])
    when = 0.5 - np.sqrt(max(0.25 - 0.25 * short / way, 0.0)) if back else short / way
    scene = linkage(count, ground, drawn, {"polynomial": law.coef.tolist()})
    if method == "newton-cold" and back:
        # It knows instants only: it is refused where one of them is beyond the line.
        there = drawn + law(scene.instants) >= np.pi
        if not there.any():
            return
        when = float(scene.instants[np.argmax(there)])
    motion, reason = tried(scene, method)
    assert reason
    if method in ("series", *AT_INSTANTS):
        assert "singular" in reason or "cannot be assembled" in reason
    if motion is not None:
        assert motion.times[-1] <= when
        # Within 1e-8 of a crossing rounding of 1e-13 mm moves a pin by 1e-5 mm.
        assert off(motion, count, ground, drawn + law(motion.times)) < 1e-4
    elif method in ("series", "newton", "chord"):
        raise AssertionError("not even the start is answered")


@by_solver
@pytest.mark.parametrize("ends", [True, False])
@few
@given(count=loops, ground=grounds, drawn=st.floats(0.5, 2.5), short=st.sampled_from([1e-6, 1e-5, 1e-3]))
def test_cranks_that_come_near_the_line_are_answered(
    method: str, ends: bool, count: int, ground: float, drawn: float, short: float
) -> None:
    way = np.pi - drawn - short
    law = [0.0, way] if ends else [0.0, 4.0 * way, -4.0 * way]
    motion, reason = tried(linkage(count, ground, drawn, {"polynomial": law}), method)
    assert motion is not None
    assert not reason
    angles = drawn + np.polynomial.Polynomial(law)(motion.times)
    # mm: 1e-13 of a metre, amplified by the inverse of the distance from the crossing; and the tolerance.
    assert off(motion, count, ground, angles) < 1e-6 + 1e-12 / short


@by_solver
@pytest.mark.parametrize(("count", "beyond"), [(1, 0.0), (2, 0.7)])
def test_a_start_beyond_the_line_is_refused(method: str, count: int, beyond: float) -> None:
    scene = linkage(count, 1400.0, np.pi / 2, {"polynomial": [np.pi / 2 + beyond, 0.1]})
    motion, reason = tried(scene, method)
    assert motion is None
    assert "cannot be assembled" in reason


@by_method
@few
@given(count=loops, ground=grounds, drawn=st.floats(0.9, 2.5), beyond=st.sampled_from([0.03, 0.2]))
def test_loops_of_one_block_that_pass_the_line_together_are_refused_there(
    method: str, count: int, ground: float, drawn: float, beyond: float
) -> None:
    # Each loop changes the sign of the block's determinant: two of them leave it as it was.
    t = np.linspace(0.0, 1.0, 2001)

    def distance(angle: Array) -> Array:
        first = CRANK * np.stack([np.cos(angle), np.sin(angle)])
        last = np.stack([ground * count - 0.6 * first[1], 0.6 * first[0]])
        return np.asarray(np.hypot(*(last - first)))

    there = np.pi - drawn + beyond
    law = np.polynomial.Polynomial.fit(
        t, distance(drawn + there * t), 16, domain=[0.0, 1.0], window=[0.0, 1.0]
    )
    scene = linkage(count, ground, drawn, {"polynomial": law.coef.tolist()}, across=True)
    motion, reason = tried(scene, method)
    assert reason
    if motion is not None:
        assert motion.times[-1] <= (np.pi - drawn) / there
        # mm: what the polynomial of degree 16 is off, some times amplified.
        assert off(motion, count, ground, drawn + there * motion.times) < 1e-2
