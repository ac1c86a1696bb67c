"""Forces: where there are none, and what they need; statics are in tests/mechanisms."""

from typing import Any

import numpy as np
import pytest
from shipped import Motion
from test_mechanisms import four_bar

import absolute

FORCE, MOMENT = np.array([300.0, -900.0, 4000.0]), np.array([2e4, -5e4, 1e4])
LOAD = {"force": FORCE.tolist(), "moment": MOMENT.tolist()}


def solve(described: dict[str, Any], values: dict[str, float], **options: Any) -> Any:
    """At values of the inputs."""
    return Motion(described, {name: np.array([[value, 0.0, 0.0]]) for name, value in values.items()}).solve(
        **options
    )


def trailing_link(**changed: Any) -> dict[str, Any]:
    """A link of 400 mm, hinged ahead of the wheel, with a damper straight above its middle."""
    points = {
        "pivot": (-400.0, -700.0, 300.0),
        "pivot_end": (-400.0, -500.0, 300.0),
        "inner": (0.0, -600.0, 300.0),
        "centre": (0.0, -700.0, 300.0),
        "foot": (-200.0, -700.0, 300.0),
        "top": (-200.0, -700.0, 600.0),
    }
    return {
        "name": "trailing link",
        "bodies": {
            "chassis": ["pivot", "pivot_end", "top"],
            "link": ["pivot", "pivot_end", "inner", "centre", "foot"],
        },
        "inputs": {"turn": {"angle": "link", "from": "drawing", "on": "chassis"}},
        "roles": {"wheel_axis": ["inner", "centre"], "damper": ["top", "foot"], "knuckle": "link"},
        "points": points,
        "up": (0, 0, 1),
        "right": (0, 1, 0),
        "side": "left",
        "wheel_radius": 300.0,
        "loads": {"": {"force": [0.0, 0.0, 1000.0]}},
        **changed,
    }


def test_a_damper_at_its_dead_point_has_no_force() -> None:
    # Its line goes through the hinge of the link.
    dead = trailing_link()
    dead["points"]["top"] = (-800.0, -700.0, 300.0)
    found = solve(dead, {"turn": 0.0}, loads=True)
    assert np.isnan(found.rod_force["damper"]).all()
    assert np.isfinite(found.position["centre"]).all()


def test_forces_are_given_only_where_they_are_asked_for() -> None:
    assert not solve(trailing_link(), {"turn": 0.0}).rod_force
    forces = solve(trailing_link(), {"turn": 0.0}, loads=True)
    with pytest.raises(ValueError, match="read-only"):
        forces.rod_force["damper"][0] = 0.0


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"loads": {}}, r"^there are no loads: write \[mechanism.loads\]"),
        ({"loads": {"left": LOAD}}, "^the part of a load is 'left'"),
        ({"loads": {"": {}}}, "^force of load '' is None; three finite numbers"),
        ({"loads": {"": {"force": [0.0, 1.0, np.nan]}}}, "^force of load '' is .*three finite numbers"),
        ({"loads": {"": LOAD | {"moment": 5.0}}}, "^moment of load '' is .*three finite numbers"),
        ({"wheel_radius": None}, "^the load of the wheel needs wheel_radius"),
        ({"roles": {"damper": ["top", "foot"]}}, "^the load of the wheel needs the role 'knuckle'"),
        ({"roles": trailing_link()["roles"] | {"damper": ["centre", "foot"]}}, "keep their distance in"),
    ],
)
def test_what_a_load_lacks_is_said_in_one_line(changed: dict[str, Any], words: str) -> None:
    with pytest.raises(absolute.DescriptionError, match=words) as refused:
        solve(trailing_link(**changed), {"turn": 0.0}, loads=True)
    assert "\n" not in str(refused.value)


def test_rows_that_follow_from_each_other_are_named() -> None:
    bars = four_bar(roles={"wheel_axis": ["q1", "q2"], "knuckle": "coupler"}, wheel_radius=300.0)
    with pytest.raises(absolute.AbsoluteError, match=r"hold each body once; hinge of") as refused:
        solve(bars | {"loads": {"": LOAD}}, {"turn": 0.0}, loads=True)
    assert solve(bars, {"turn": 0.0}).position
    assert "\n" not in str(refused.value)
