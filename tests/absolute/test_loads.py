"""Forces: where there are none, and what they need; statics are in tests/mechanisms."""

from typing import Any

import numpy as np
import pytest
from one_arm import DRAWN, ROLES, plain
from shipped import Motion
from test_mechanisms import four_bar

import absolute

LOAD = {"force": [300.0, -900.0, 4000.0], "moment": [2e4, -5e4, 1e4]}


def solve(described: dict[str, Any], loads: bool = True) -> absolute.Solution:
    """At inputs of zero."""
    return Motion(described, {name: np.zeros((1, 3)) for name in described["inputs"]}).solve(loads=loads)


def loaded(points: Any = DRAWN, **changed: Any) -> dict[str, Any]:
    return plain(points, **({"loads": {"": LOAD}} | changed))


def test_a_damper_at_its_dead_point_has_no_force() -> None:
    # Its line goes through the hinge of the arm.
    beyond = np.add(DRAWN["pivot_end"], np.subtract(DRAWN["pivot_end"], DRAWN["pivot"]))
    found = solve(loaded({**DRAWN, "damper_top": beyond}))
    assert np.isnan(found.rod_force["damper"]).all()
    assert np.isfinite(found.position["centre"]).all()


def test_forces_are_given_only_where_they_are_asked_for() -> None:
    assert not solve(loaded(), loads=False).rod_force
    with pytest.raises(ValueError, match="read-only"):
        solve(loaded()).rod_force["damper"][0] = 0.0


BARS = four_bar(roles={"wheel_axis": ["q1", "q2"], "knuckle": "coupler"}, wheel_radius=300.0)


@pytest.mark.parametrize(
    ("described", "words"),
    [
        (loaded(loads={}), r"^there are no loads: write \[mechanism.loads\]"),
        (loaded(loads={"left": LOAD}), "^the part of a load is 'left'"),
        (loaded(loads={"": {}}), "^force of load '' is None; three finite numbers"),
        (loaded(loads={"": {"force": [0.0, 1.0, np.nan]}}), "^force of load '' is .*three finite numbers"),
        (loaded(loads={"": LOAD | {"moment": 5.0}}), "^moment of load '' is .*three finite numbers"),
        (loaded(wheel_radius=None), "^the load of the wheel needs wheel_radius"),
        (loaded(roles={"damper": ROLES["damper"]}), "^the load of the wheel needs the role 'knuckle'"),
        (loaded(roles={**ROLES, "damper": ["centre", "damper_foot"]}), "keep their distance in"),
        # Its rows follow from each other.
        (BARS | {"loads": {"": LOAD}}, r"hold each body once; hinge of"),
    ],
)
def test_what_a_load_lacks_is_said_in_one_line(described: dict[str, Any], words: str) -> None:
    with pytest.raises(absolute.DescriptionError, match=words) as refused:
        solve(described)
    assert "\n" not in str(refused.value)
