"""One file for all models means one wrong file for all: closed forms and printed tables notice it.

A fault is planted in the tables of a shipped file. The reference refuses it, or the poses that it finds are
far from what is right.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import pytest
from mechanism_checks import PRINTED, closed_form_check
from mechanism_files import MECHANISMS, Tables

from validate.reference import NoReferenceError

Change = Callable[[Tables, Tables], object]
"""What is changed in the tables of the mechanism and of the scene's drawing."""


@dataclass(frozen=True)
class Fault:
    """A fault in a mechanism file and how it is noticed.

    Attributes:
        held_to: "printed" or the scene of the closed form.
        notice: a quantity, or, of what is refused, words of the reason.
        by: by how much at least the quantity is off, mm, rad or, in the Lotus table, degrees.
    """

    mechanism: str
    what: str
    change: Change
    held_to: str
    notice: str
    by: float = 0.0


def swap(first: tuple[str, str], second: tuple[str, str], table: str = "bodies") -> Change:
    """Two entries exchange a name each: (entry, name)."""

    def change(tables: Tables, part: Tables) -> None:
        for (entry, name), (_, other) in ((first, second), (second, first)):
            tables[table][entry] = [other if each == name else each for each in tables[table][entry]]

    return change


def rename(entry: str, name: str, other: str, table: str = "bodies") -> Change:
    """An entry has another name in place of one."""

    def change(tables: Tables, part: Tables) -> None:
        old = tables[table][entry]
        if isinstance(old, dict):
            tables[table][entry] = {key: other if value == name else value for key, value in old.items()}
        else:
            tables[table][entry] = [other if each == name else each for each in old]

    return change


def drop(rod: str) -> Change:
    return lambda tables, part: tables["rods"].pop(rod)


def add(rod: str, *ends: str) -> Change:
    return lambda tables, part: tables["rods"].update({rod: list(ends)})


def hand_over(point: str, body: str, other: str) -> Change:
    """A point is on the list of another body."""

    def change(tables: Tables, part: Tables) -> None:
        tables["bodies"][body].remove(point)
        tables["bodies"][other].append(point)

    return change


def backwards(body: str) -> Change:
    """The body lists the two points of its hinge the other way round."""

    def change(tables: Tables, part: Tables) -> None:
        first, second, *rest = tables["bodies"][body]
        tables["bodies"][body] = [second, first, *rest]

    return change


# fmt: off
FAULTS = (
    Fault("double_wishbone", "the arms hold each other's ball joint",
          swap(("lower_arm", "lower_ball_joint"), ("upper_arm", "upper_ball_joint")), "printed", "camber", 1),
    Fault("double_wishbone", "the upper arm turns about a pivot of the lower one",
          rename("upper_arm", "upper_arm_rear", "lower_arm_rear"), "printed", "camber", 1),
    Fault("double_wishbone", "no tie rod",
          drop("tie_rod"), "printed", "drive 1 more"),
    Fault("double_wishbone", "a second tie rod",
          add("tie_rod_2", "upper_arm_rear", "tie_rod_outer"), "printed", "locked"),
    Fault("double_wishbone", "the rack goes the other way",
          rename("rack", "left", "right", "slides"), "double-wishbone", "position", 10.0),
    Fault("double_wishbone", "the rack slides forward",
          rename("rack", "left", "forward", "slides"), "double-wishbone", "position", 10.0),
    Fault("double_wishbone", "the rack's line goes through an arm's pivot",
          rename("rack", "rack_centre", "lower_arm_front", "slides"), "double-wishbone", "position", 10.0),
    Fault("double_wishbone", "bump counts downwards",
          lambda t, p: t["inputs"].update(wheel_travel={"height": "wheel_centre", "along": "down"}),
          "hmmwv-front", "position", 10.0),
    Fault("double_wishbone", "bump is the inner point's",
          rename("wheel_travel", "wheel_centre", "wheel_axis_inner", "inputs"),
          "hmmwv-front", "position", 0.1),
    Fault("double_wishbone", "the arm's angle is measured from below",
          rename("arm_angle", "up", "down", "inputs"), "double-wishbone", "position", 10.0),
    Fault("macpherson", "the strut's line goes through the tie rod's end",
          rename("strut", "strut_lower", "tie_rod_outer", "slides"), "off-axis-strut", "position", 50),
    Fault("macpherson", "the strut's line goes towards the tie rod's end",
          rename("strut", "strut_top", "tie_rod_outer", "slides"), "off-axis-strut", "position", 50),
    Fault("macpherson", "the strut slides in the arm",
          rename("strut", "knuckle", "lower_arm", "slides"), "off-axis-strut", "a point of lower_arm"),
    Fault("macpherson", "no strut rod",
          drop("strut_rod"), "off-axis-strut", "drive 1 more"),
    Fault("five_link", "two links hold each other's outer point",
          swap(("upper_front", "upper_front_outer"), ("lower_front", "lower_front_outer"), "rods"),
          "printed", "camber", 0.1),
    Fault("five_link", "a link hangs on another's ground point",
          rename("toe", "toe_inner", "upper_front_inner", "rods"), "printed", "toe", 1e-3),
    Fault("five_link", "four links",
          drop("lower_rear"), "printed", "drive 1 more"),
    Fault("five_link", "six links",
          add("sixth", "toe_inner", "wheel_centre"), "printed", "locked"),
    Fault("five_link", "bump counts downwards",
          lambda t, p: t["inputs"].update(wheel_travel={"height": "wheel_centre", "along": "down"}),
          "printed", "camber", 1e-2),
    Fault("five_link", "a ground point of the drawing is 1 mm too high",
          lambda t, p: p.update(points=p["points"] | {"toe_inner": [1550, -420, 321]}),
          "printed", "toe", 1e-4),
    Fault("semi_trailing_arm", "the hinge has one point",
          lambda t, p: t["bodies"]["arm"].remove("pivot_outer"), "printed", "drive 2 more"),
    Fault("semi_trailing_arm", "bump counts downwards",
          lambda t, p: t["inputs"].update(wheel_travel={"height": "wheel_centre", "along": "down"}),
          "printed", "camber", 1e-2),
    Fault("semi_trailing_arm", "a ground point of the drawing is 1 mm too high",
          lambda t, p: p.update(points=p["points"] | {"pivot_outer": [750, -620, 201]}),
          "printed", "camber", 1e-5),
    Fault("double_wishbone_pushrod", "the upper arm carries the pushrod",
          hand_over("pushrod_outer", "lower_arm", "upper_arm"), "pushrod", "position", 10),
    Fault("double_wishbone_pushrod", "the rocker turns about the damper's top",
          rename("rocker", "rocker_rear", "damper_top"), "pushrod", "position", 10),
    Fault("double_wishbone_pushrod", "the damper is measured from the pushrod",
          lambda t, p: t["inputs"].update(damper_length={"distance": ["damper_top", "pushrod_inner"]}),
          "pushrod-by-damper", "position", 90),
    Fault("spatial_four_bar", "the crank turns the other way",
          backwards("crank"), "spatial-four-bar", "position", 10.0),
    Fault("spatial_four_bar", "the rocker turns about a point of the crank's axis",
          rename("rocker", "rocker_axis_end", "crank_axis_end"), "spatial-four-bar", "turns back at a fold"),
    Fault("slider_crank", "the crank turns the other way",
          backwards("crank"), "slider-crank", "position", 1.0),
    Fault("slider_crank", "the piston slides sideways",
          rename("bore", "up", "right", "slides"), "slider-crank", "singular pose"),
    Fault("slider_crank", "the bore goes through the crank's axis",
          rename("bore", "bore", "crank_axis", "slides"), "slider-crank", "position", 5),
    Fault("andrews_squeezer", "a lever turns about the wrong pin",
          lambda t, p: t["bodies"].update(K5=["B", "B_pin", "G"]), "printed", "angles at the end", 0.1),
    Fault("andrews_squeezer", "the crank turns the other way",
          backwards("K1"), "printed", "angles at the end", 1e-2),
    Fault("n_four_bar", "the crank turns the other way",
          backwards("crank_0"), "n-four-bar", "position", 100.0),
    Fault("n_four_bar", "a crank turns about another's pin",
          rename("crank_2", "A2", "A1"), "n-four-bar", "position", 200),
    Fault("bricard", "two links hold each other's corner",
          swap(("link_2", "P2"), ("link_3", "P3")), "printed", "singular pose"),
    Fault("bricard", "the input turns the other way",
          backwards("link_1"), "printed", "position", 10.0),
    Fault("bricard", "a ground hinge has one point",
          lambda t, p: t["bodies"]["link_5"].remove("Q5"), "printed", "drive 1 more"),
    Fault("axle", "the left wheel is not mirrored",
          lambda t, p: t["parts"]["left"].pop("mirrored"), "axle-steer", "position", 1.0),
    Fault("axle", "one end of the rack stands still",
          lambda t, p: t["inputs"].update(rack={"travel": "left.rack"}), "axle-steer", "drive 1 more"),
    Fault("rolling_axle", "the car rolls the other way",
          rename("roll", "forward", "rearward", "inputs"), "axle-roll", "position", 10.0),
    Fault("rolling_axle", "the car rolls about a wheel centre's height and side",
          lambda t, p: p.update(points=p["points"] | {"roll_axis": [0, 718, 210]}),
          "axle-roll", "position", 1.0),
    Fault("rolling_axle", "a wheel keeps its height in the chassis",
          lambda t, p: t["inputs"]["left.ground_height"].pop("over"), "axle-roll", "position", 5.0),
)
# fmt: on


@pytest.mark.parametrize("fault", FAULTS, ids=lambda fault: f"{fault.mechanism}: {fault.what}")
def test_a_fault_in_a_mechanism_file_is_noticed(fault: Fault) -> None:
    check = PRINTED[fault.mechanism]() if fault.held_to == "printed" else closed_form_check(fault.held_to)
    assert check.type == fault.mechanism
    if fault.notice in check.limits:
        found = check.deviations_of(check.plain(fault.change))
        assert found[fault.notice] > max(fault.by, 10 * check.limits[fault.notice])
    else:
        with pytest.raises(NoReferenceError, match=fault.notice):
            check.deviations_of(check.plain(fault.change))


def test_faults_are_planted_in_every_shipped_mechanism() -> None:
    assert {fault.mechanism for fault in FAULTS} == set(MECHANISMS)


def test_a_rod_that_is_written_twice_changes_nothing() -> None:
    check = closed_form_check("hmmwv-front")
    found = check.deviations_of(check.plain(add("tie_rod_2", "tie_rod_inner", "tie_rod_outer")))
    assert found["position"] <= check.limits["position"]
