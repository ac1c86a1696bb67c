"""What rides on a body is put together at each instant as its series says."""

import numpy as np
import pytest

from pointcoord import Scene, designs_of
from pointcoord.linkage.chassis import ChassisMotion
from pointcoord.linkage.hardpoints import build_mechanism
from pointcoord.method import SERIES
from pointcoord.numerics.rounding import EPS
from pointcoord.results.readout import Readout
from pointcoord.results.states import StatesOfChain
from pointcoord.results.states_of_designs import CARRIED, StatesOfDesigns
from pointcoord.simulation import chain_settings, pose_tolerance
from pointcoord.solve import box
from pointcoord.solve.designs import solve_designs
from pointcoord.sweeping.solving import Course


@pytest.mark.parametrize("name", ["double-wishbone", "off-axis-strut", "steer"])
@pytest.mark.parametrize("effects", [("velocity", "acceleration", "knuckle_rates", "wheel_angles"), ("toe",)])
@pytest.mark.parametrize("count", [3, CARRIED + 8])
@pytest.mark.parametrize("points", [None, ("wheel_centre", "lower_arm_front")])
def test_states_of_designs_are_those_of_their_series(
    name: str,
    effects: tuple[str, ...],
    points: tuple[str, ...] | None,
    count: int,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    # The plain sums are of series in time.
    monkeypatch.setattr(box, "INPUTS", 0)
    scene = Scene.load(name).model_copy(update={"effects": effects, "points": points})
    designs = designs_of(scene, offsets={"tie_rod_outer.z": np.linspace(-3.0, 2.0, count)})
    part, time = scene.mechanism, scene.time
    directions = {"up": part.up, "right": part.right}
    mechanism = build_mechanism(part.topology, designs.points(np.arange(count)), directions)
    functions = {name: scene.functions[name] for name in mechanism.topology.required_inputs}
    course = Course.of(designs)
    settings = chain_settings(scene, mechanism, course.plan.derivative)
    allowed = pose_tolerance(scene, SERIES, mechanism)
    solved = solve_designs(mechanism, functions, time.start, time.stop, settings, allowed)
    (chain,) = (each.chain for each in solved.followed)
    readout = Readout(mechanism, course.plan, ChassisMotion.of(mechanism, scene.functions), course.axes)
    quick, plain = (
        kind(readout, functions, chain, time.start).states(scene.instants)
        for kind in (StatesOfDesigns, StatesOfChain)
    )
    largest = [max(float(np.abs(state).max()) for state in each.values()) for each in plain]
    for order, (one, other) in enumerate(zip(quick, plain, strict=True)):
        for point, state in other.items():
            # Sums of some ten rounded terms of the size of a state, or of products of two lower ones, which
            # lie within the size of the car: 1000 roundings cover series of 40 orders.
            size = largest[order] + mechanism.unit.max() * (order == 2)
            assert np.abs(one[point] - state).max() <= 1000.0 * EPS * size
