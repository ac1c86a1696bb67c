r"""Shipped mechanisms in closed form, in many digits: turns about axes, one after the other.

A point q that turns about an axis and is the end of a rod whose other end x is known stands where

    A cos(phi) + B sin(phi) = C,      phi = atan2(B, A) -+ acos(C / |(A, B)|).

The side is the drawing's: along a motion without a singular pose it cannot change. So does an arm's end that
is at a given height. Where the input is another one, the turn that gives its value is found first, along the
motion from the drawing.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any

import mpmath
import numpy as np
from many_digits import DIGITS, Array, Points, beside, unit, vector
from mpmath import acos, asin, atan2, cos, hypot, mp, mpf, sign, sin, sqrt

Inputs = Mapping[str, Any]
Move = Callable[[Array], Array]


class NoPoseError(Exception):
    """Circles and spheres that do not meet."""


UP, LEFT, FORWARD = vector([0, 0, 1]), vector([0, -1, 0]), vector([-1, 0, 0])
# Steps in which the first instant's input is reached from the drawing.
STEPS = 8


def turn(axis: tuple[Array, Array], angle: Any) -> Move:
    """The rotation about the line from one point to another, right-handed."""
    start, along = axis[0], unit(axis[1] - axis[0])

    def move(point: Array) -> Array:
        arm = point - start
        return (
            start
            + arm * cos(angle)
            + np.cross(along, arm) * sin(angle)
            + along * (along @ arm) * (1 - cos(angle))
        )

    return move


def turned_to(a: Any, b: Any, c: Any, side: Any) -> Any:
    """The angle phi of one side with a cos(phi) + b sin(phi) = c."""
    if abs(c) > hypot(a, b):
        raise NoPoseError
    return atan2(b, a) - side * acos(c / hypot(a, b))


def root(square: Any) -> Any:
    """A length from its square."""
    if square < 0:
        raise NoPoseError
    return sqrt(square)


def raised(point: Array, axis: tuple[Array, Array], height: Any) -> Any:
    """The angle by which a point turns about an axis until it is so high over the axis' start, as drawn."""
    along = unit(axis[1] - axis[0])
    middle = along * (along @ (point - axis[0]))
    radius = point - axis[0] - middle
    a, b = radius @ UP, np.cross(along, radius) @ UP
    return turned_to(a, b, height - middle @ UP, sign(b))


def swing(point: Array, axis: tuple[Array, Array], end: Array, square: Any, side: Any) -> Any:
    """The angle by which a point turns about an axis until it is at a distance from `end`."""
    along = unit(axis[1] - axis[0])
    radius = (point - axis[0]) - along * (along @ (point - axis[0]))
    middle = point - radius - end
    a, b = middle @ radius, middle @ np.cross(along, radius)
    c = (square - middle @ middle - radius @ radius) / 2
    return turned_to(a, b, c, side)


def side(point: Array, axis: tuple[Array, Array], end: Array) -> Any:
    """On which side of the plane through the axis and `end` a point is drawn."""
    return sign((point - end) @ np.cross(axis[1] - axis[0], point - axis[0]))


def swung(p: Points, point: str, axis: tuple[str, str], end: str, end_now: Array) -> Move:
    """The rotation about a fixed axis that keeps a rod's length while its other end moves."""
    line = (p[axis[0]], p[axis[1]])
    rod = p[point] - p[end]
    return turn(line, swing(p[point], line, end_now, rod @ rod, side(p[point], line, p[end])))


def knuckle(p: Points, drawn: tuple[Array, Array], now: tuple[Array, Array], tie_rod_inner: Array) -> Move:
    """The motion of a body whose axis is known and that a tie rod steers."""
    before, after = (np.stack([a := unit(e[1] - e[0]), b := beside(a), np.cross(a, b)]) for e in (drawn, now))

    def laid(point: Array) -> Array:
        return now[0] + after.T @ (before @ (point - drawn[0]))

    rod, outer = p["tie_rod_outer"] - p["tie_rod_inner"], p["tie_rod_outer"]
    hand = side(outer, drawn, p["tie_rod_inner"])
    spin = turn(now, swing(laid(outer), now, tie_rod_inner, rod @ rod, hand))
    return lambda point: spin(laid(point))


def moved(p: Points, bodies: Mapping[Move, Sequence[str]]) -> Points:
    """All points, those of bodies where the bodies take them."""
    return {**p, **{name: move(p[name]) for move, names in bodies.items() for name in names if name in p}}


def double_wishbone(p: Points, angle: Any, inputs: Inputs) -> Points:
    inner = p["rack_centre"] + LEFT * mpf(inputs["rack"])
    arm = turn((p["lower_arm_front"], p["lower_arm_rear"]), angle)
    low, high = "lower_ball_joint", "upper_ball_joint"
    upper = swung(p, high, ("upper_arm_front", "upper_arm_rear"), low, arm(p[low]))
    wheel = knuckle(p, (p[low], p[high]), (arm(p[low]), upper(p[high])), inner)
    bodies = {
        arm: [low, "pushrod_outer"],
        upper: [high],
        wheel: ["tie_rod_outer", "wheel_axis_inner", "wheel_centre"],
    }
    if "rocker_front" in p:
        outer = arm(p["pushrod_outer"])
        rocker = swung(p, "pushrod_inner", ("rocker_front", "rocker_rear"), "pushrod_outer", outer)
        bodies[rocker] = ["pushrod_inner", "damper_rocker"]
    return {**moved(p, bodies), "tie_rod_inner": inner}


def macpherson(p: Points, angle: Any, inputs: Inputs, through: str, towards: str) -> Points:
    inner = p["rack_centre"] + LEFT * mpf(inputs["rack"])
    arm = turn((p["lower_arm_front"], p["lower_arm_rear"]), angle)
    joint, top, line = p["lower_ball_joint"], p["strut_top"], unit(p[towards] - p[through])
    # Where on the knuckle's line the strut's top is now: as far from the ball joint as that has gone from it.
    now = arm(joint)
    apart, foot = top - now, (joint - p[through]) @ line
    beyond = root(apart @ apart - (joint - p[through]) @ (joint - p[through]) + foot**2)
    on_line = p[through] + line * (foot + beyond * sign((top - p[through]) @ line - foot))
    wheel = knuckle(p, (joint, on_line), (now, top), inner)
    rod, end = p["strut_rod_end"] - top, p["strut_rod_end"] - p[through]
    carried = ["strut_lower", "tie_rod_outer", "wheel_axis_inner", "wheel_centre"]
    found = moved(p, {arm: ["lower_ball_joint"], wheel: carried})
    down = sign((end - (top - p[through])) @ line) * sqrt(rod @ rod)
    return {**found, "strut_rod_end": wheel(on_line + line * down), "tie_rod_inner": inner}


def semi_trailing_arm(p: Points, angle: Any, inputs: Inputs) -> Points:
    return moved(p, {turn((p["pivot_inner"], p["pivot_outer"]), angle): ["wheel_axis_inner", "wheel_centre"]})


def spatial_four_bar(p: Points, angle: Any, inputs: Inputs) -> Points:
    crank = turn((p["crank_axis"], p["crank_axis_end"]), angle)
    axis = ("rocker_axis", "rocker_axis_end")
    rocker = swung(p, "rocker_pin", axis, "crank_pin", crank(p["crank_pin"]))
    return moved(p, {crank: ["crank_pin"], rocker: ["rocker_pin"]})


def slider_crank(p: Points, angle: Any, inputs: Inputs) -> Points:
    crank = turn((p["crank_axis"], p["crank_axis_end"]), angle)
    rod, from_pin = p["piston"] - p["crank_pin"], p["bore"] - crank(p["crank_pin"])
    beyond = sqrt(rod @ rod - from_pin @ from_pin + (from_pin @ UP) ** 2)
    piston = p["bore"] + UP * (sign(rod @ UP) * beyond - from_pin @ UP)
    return {**moved(p, {crank: ["crank_pin"]}), "piston": piston}


def andrews_squeezer(p: Points, angle: Any, inputs: Inputs) -> Points:
    crank = turn((p["O"], p["O_pin"]), angle)
    wide = swung(p, "E", ("B", "B_pin"), "F", crank(p["F"]))
    lever, other = (swung(p, name, ("A", "A_pin"), "E", wide(p["E"])) for name in "GH")
    return moved(p, {crank: ["F"], wide: ["E"], lever: ["G"], other: ["H"]})


def n_four_bar(p: Points, angle: Any, inputs: Inputs) -> Points:
    cranks = {turn((p[f"A{k}"], p[f"A{k}_pin"]), angle): [f"B{k}"] for k in range(3)}
    return moved(p, cranks)


def bricard(p: Points, angle: Any, inputs: Inputs) -> Points:
    """Turns alternate: theta, and asin(-sin(theta) / (1 + sin(theta)))."""
    other, now = asin(-sin(angle) / (1 + sin(angle))), dict(p)
    for joint in range(5):  # each turn takes along all links after it
        move = turn((now[f"P{joint}"], now[f"Q{joint}"]), other if joint % 2 else angle)
        later = [f"{letter}{k}" for k in range(joint + 1, 6) for letter in "PQ"]
        now |= {name: move(now[name]) for name in later}
    return now


FORMS: Mapping[str, Callable[[Points, Any, Inputs], Points]] = {
    "double_wishbone": double_wishbone,
    "double_wishbone_pushrod": double_wishbone,
    "macpherson": partial(macpherson, through="strut_lower", towards="strut_top"),
    "macpherson collinear": partial(macpherson, through="lower_ball_joint", towards="strut_lower"),
    "semi_trailing_arm": semi_trailing_arm,
    "spatial_four_bar": spatial_four_bar,
    "slider_crank": slider_crank,
    "andrews_squeezer": andrews_squeezer,
    "n_four_bar": n_four_bar,
    "bricard": bricard,
}


def contact(p: Points, radius: Any) -> Array:
    """The lowest point of a thin disc about the wheel's axis."""
    axis = unit(p["wheel_centre"] - p["wheel_axis_inner"])
    return p["wheel_centre"] - mpf(radius) * unit(UP - axis * (axis @ UP))


def measured(name: str, p: Points, drawn: Points, radius: Any, inputs: Inputs) -> Any:
    """What an input that is no turn reads at a pose."""
    if name == "damper_length":
        return sqrt(sum((p["damper_top"] - p["damper_rocker"]) ** 2))
    if name == "ground_height":
        roll = turn((p["roll_axis"], p["roll_axis"] + FORWARD), mpf(inputs["roll"]))
        rolled = {point: roll(place) for point, place in p.items()}
        return (contact(rolled, radius) - contact(drawn, radius)) @ UP
    if name == "contact_travel":
        return (contact(p, radius) - contact(drawn, radius)) @ UP
    return {"wheel_travel": lambda: (p["wheel_centre"] - drawn["wheel_centre"]) @ UP}[name]()


def closed_form(
    type: str, points: Mapping[str, Any], path: Sequence[Inputs], radius: Any = None
) -> list[Points]:
    """All points at each of some inputs, mm, in the chassis' axes of the shipped scenes."""
    with mp.workdps(DIGITS):
        p = {name: vector(place) for name, place in points.items()}
        p.setdefault("rack_centre", p.get("tie_rod_inner"))
        p = {name: place for name, place in p.items() if place is not None}
        form, found, angle = FORMS[type], [], mpf(0)
        known = ("rack", "heave", "roll", "crank", "turn", "arm_turn", "rocker_turn")
        sought = [name for name in path[0] if name not in known]
        if not sought:
            turns = [next(mpf(inputs[k]) for k in inputs if k not in ("rack", "heave")) for inputs in path]
            return [form(p, angle, inputs) for angle, inputs in zip(turns, path, strict=True)]
        (name,) = sought
        if name == "arm_angle":
            ball, axis = p["lower_ball_joint"], (p["lower_arm_front"], p["lower_arm_rear"])
            arm = sqrt(sum((ball - axis[0]) ** 2))
            return [form(p, raised(ball, axis, arm * cos(one[name])), one) for one in path]
        start = measured(name, form(p, angle, {"rack": 0}), p, radius, {"roll": 0})
        ways = [{**path[0], name: start + (path[0][name] - start) * k / STEPS} for k in range(1, STEPS)]
        for inputs in [*ways, *path]:

            def miss(angle: Any, inputs: Inputs = inputs) -> Any:
                return measured(name, form(p, angle, inputs), p, radius, inputs) - mpf(inputs[name])

            angle = mpmath.findroot(miss, (angle, angle + mpf("1e-3")), tol=mpf(10) ** (-2 * DIGITS + 12))
            found.append(form(p, angle, inputs))
        return found[len(ways) :]
