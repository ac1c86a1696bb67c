"""Numbers of wheels by programs equal those of the reference; wheels without a contact point are refused."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from mechanism_files import mechanism_file, plain, plain_scene

from pointcoord.numerics.arrays import Array
from validate.errors import NoAnswer
from validate.peers.in_pinocchio import InPinocchio
from validate.peers.motion import OF_CAR
from validate.peers.motion import numbers as numbers_of
from validate.reference import Design, instants_of
from validate.reference.effects.registry import ANGLES, EFFECTS
from validate.reference.effects.wheel import OF_POSITIONS
from validate.spanning_tree.cut import cut

# Lengths are at most 1 m; places have some ten roundings, magnified at most a hundred times; an angle is that
# of a line of 50 mm.
WITHIN_MM, WITHIN_RAD = 1e-10, 2e-12
SCENES = ("pushrod", "off-axis-strut")


def moved(name: str) -> tuple[dict[str, Any], dict[str, Array]]:
    """A mechanism on a chassis that rolls, pitches and is displaced, and three poses near its drawing."""
    plain = plain_scene(name, wheel_radius=300.0)
    first, second = plain["bodies"]["chassis"][:2]
    plain["inputs"] |= {
        "roll": {"turns": "chassis", "about": first, "along": "forward"},
        "pitch": {"turns": "chassis", "about": second, "along": "right"},
        "aside": {"moves": "chassis", "along": "right"},
        "up": {"moves": "chassis", "along": "up"},
    }
    tree = cut(plain)
    drawn, unit = {driven.input: driven for driven in tree.driven}, tree.unit
    values = {n: d.drawn if d.is_angle else d.drawn * unit for n, d in drawn.items()}
    sizes = {n: 0.1 if d.is_angle else 8.0 for n, d in drawn.items()}
    values |= {"roll": 0.03, "pitch": -0.02, "aside": 40.0, "up": -70.0, "heave": 5.0}
    laws = {}
    for n in plain["inputs"]:
        going = values[n] + sizes.get(n, 0.01) * np.array([-1.0, 0.3, 1.0])
        laws[n] = np.stack([going, 0.0 * going, 0.0 * going], axis=-1)
    return plain, laws


def found(plain: dict[str, Any], laws: dict[str, Array], *effects: Any) -> dict[str, Array]:
    tree = cut(plain)
    program = InPinocchio(tree)
    poses = program.poses(tree.series(laws)[..., 0], 1e-12, program.closed(1e-12))
    return numbers_of(tree, laws, poses, None, *effects)[OF_CAR]


@pytest.mark.parametrize("name", SCENES)
def test_witnesses_give_every_number_of_positions(name: str) -> None:
    plain, laws = moved(name)
    numbers = found(plain, laws, EFFECTS)
    each = [{n: tuple(law[i].tolist()) for n, law in laws.items()} for i in range(3)]
    exact = list(instants_of(Design.from_plain(plain), each, effects=[one.name for one in OF_POSITIONS]))
    assert set(numbers) == set(exact[0].effects)
    assert ("damper_length" in numbers) == ("damper" in plain["roles"])
    for number, values in numbers.items():
        within = WITHIN_RAD if EFFECTS[number].unit == "rad" else WITHIN_MM
        wanted = [float(instant.effects[number]) for instant in exact]
        assert np.abs(values - wanted).max() < within, number


def test_only_the_numbers_that_are_asked_for_are_given_and_angles_where_none_are() -> None:
    plain, laws = moved("double-wishbone")
    assert set(found(plain, laws)) == set(ANGLES)
    asked = ["toe", "recession", "toe_by_travel", "no such number"]
    assert set(found(plain, laws, asked)) == {"toe", "recession"}


def test_a_wheel_that_lies_flat_or_has_no_radius_has_no_contact_point() -> None:
    tables, points = mechanism_file("five_link"), dict(plain_scene("five-link")["points"])
    tables["inputs"] = {"lift": {"contact": ["wheel_axis_inner", "wheel_centre"]}}
    with pytest.raises(NoAnswer, match="wheel_radius"):
        cut(plain(tables, {"points": points}, ["lift"]))
    x, y, z = points["wheel_centre"]
    points["wheel_axis_inner"] = (x, y, z - 100.0)
    with pytest.raises(NoAnswer, match="lies flat"):
        cut(plain(tables, {"points": points, "wheel_radius": 300.0}, ["lift"]))
