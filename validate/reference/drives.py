"""Kinds of input: their rows, the numbers w in these rows, and the values of w in the drawing.

    angle from a direction    (P - Q) . direction = w,          w = d cos(theta), d as drawn
    angle from the drawing    g1 w1 - g2 w2 = 0,                w1 = sin(theta), w2 = cos(theta) / |n|,
                              g1 = R e . R' e,  g2 = R e . R' (n x e),  n along the hinge, e across it
    travel of a slide         s = w                             w = travel / length of the slide's line
    turn of a steering wheel  s = w                             travel = rack_per_turn angle / (2 pi)
    height of a point         P . direction = w
    contact height            centre . g + w4 - s = w5,  s^2 + (r m / l)^2 = r^2,  m = (centre - inner) . g,
                              l the distance of centre and inner, r the wheel's radius. Over the chassis
                              g = up, w4 = 0; over the ground the point p of the moved chassis has the
                              height p . g + w4, g = (w1, w2, w3)
    distance of two points    |P - Q|^2 = w,                    w = distance^2

All lengths are in local coordinates (see `design`).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from functools import partial
from typing import Any

from flint import arb

from validate.reference.car_data import directions
from validate.reference.chassis import ChassisMotion
from validate.reference.errors import NoReferenceError
from validate.reference.exact import as_ball, as_fraction
from validate.reference.jet import Jet, angle
from validate.reference.mechanism import CHASSIS, Drive, Mechanism, Table
from validate.reference.polynomial import Polynomial
from validate.reference.vectors import Exact, Scalar, across, cross, dot, each, minus, root


def _angle(mechanism: Mechanism, name: str, spec: Mapping[str, Any]) -> Drive:
    if spec["from"] == "drawing":
        return _angle_from_drawing(mechanism, name, spec)
    end, pivot = spec["of"], spec["about"]
    along = directions(mechanism.plain)[spec["from"]]
    drawn = mechanism.drawn_line(f"inputs.{name}", pivot, end)
    d2, height = dot(drawn, drawn), dot(drawn, along)
    mechanism.row(name, dot(minus(mechanism.place(end), mechanism.place(pivot)), along) - mechanism.number())

    def input_of(numbers: Sequence[arb]) -> arb:
        # An arc cosine would lose digits if the arm is along the direction. The direction is a unit vector up
        # to rounding, so the difference may be just below zero.
        beside = (as_ball(d2) - numbers[0] * numbers[0]).nonnegative_part()
        return arb.atan2(beside.sqrt(), numbers[0])

    return Drive(
        lambda value, _, exact: [value.sin_cos()[1] * root(exact(d2))],
        input_of,
        lambda: input_of([as_ball(height)]),
    )


def _angle_from_drawing(mechanism: Mechanism, name: str, spec: Mapping[str, Any]) -> Drive:
    body, on, table = spec["angle"], spec["on"], mechanism.table
    both = [point for point in mechanism.plain["bodies"][body] if point in mechanism.plain["bodies"][on]]
    if len(both) != 2:
        raise NoReferenceError(f"inputs.{name}: angle", f"is {body!r}", f"a body hinged on {on}")
    n = minus(table[both[1]], table[both[0]])
    e, nn = across(n)[0], dot(n, n)
    turning, held = mechanism.bodies[body].turned(e), mechanism.bodies[on]
    products = [dot(turning, held.turned(v)) for v in (e, cross(n, e))]
    if on != CHASSIS:  # each product is quadratic: it becomes an unknown, so that the row stays quadratic
        for i, product in enumerate(tuple(products)):
            (products[i],) = mechanism.unknowns(1, partial(_value, product))
            mechanism.row(name, products[i] - product)
    sine, cosine = mechanism.number(), mechanism.number()
    mechanism.row(name, products[0] * sine - products[1] * cosine)

    def numbers(value: Jet, _: object, exact: Exact) -> list[Jet]:
        sin, cos = value.sin_cos()
        return [sin, cos * (1 / root(exact(nn)))]

    return Drive(numbers, lambda w: arb.atan2(w[0], w[1] * as_ball(nn).sqrt()), turns=True)


def _value(row: Polynomial, _: Table, unknown: Sequence[Scalar], exact: Exact, *__: object) -> list[Scalar]:
    return [row.of_kind(exact).at(unknown)]


def travel_per_radian(plain: Mapping[str, Any], exact: Exact = as_ball) -> Scalar:
    """Travel of a rack per rad of the steering wheel, rack_per_turn / (2 pi), mm, in any kind of number."""
    quarter = angle(exact(Fraction(1)), exact(Fraction(0)))
    return exact(as_fraction(plain["rack_per_turn"], "rack_per_turn")) / (4 * quarter)


def _travel(mechanism: Mechanism, name: str, spec: Mapping[str, Any]) -> Drive:
    """Slides that travel with an input in mm, or with the angle of a steering wheel."""
    slides, plain, unit = spec.get("travel") or spec["steers"], mechanism.plain, mechanism.unit
    lengths = [mechanism.lines[slide][2] for slide in slides]
    for slide in slides:
        mechanism.row(name, mechanism.lines[slide][0][0] - mechanism.number())
    first, along = plain["slides"][slides[0]], mechanism.lines[slides[0]][1]
    off = minus(mechanism.table[first["points"][0]], mechanism.table[first["through"]])
    drawn = dot(off, along) / dot(along, along)

    def per_input(exact: Exact) -> Scalar:
        return exact(1 / unit) * (travel_per_radian(plain, exact) if "steers" in spec else 1)

    def input_of(w: Sequence[arb]) -> arb:
        return arb(w[0] * as_ball(lengths[0]).sqrt() / per_input(as_ball))

    return Drive(
        lambda value, _, exact: [value * (per_input(exact) / root(exact(squared))) for squared in lengths],
        input_of,
        lambda: input_of([as_ball(drawn)]),
    )


def _height(mechanism: Mechanism, name: str, spec: Mapping[str, Any]) -> Drive:
    """The height of a point, measured in mm from the drawing."""
    along, unit = directions(mechanism.plain)[spec.get("along", "up")], mechanism.unit
    drawn = dot(mechanism.table[spec["height"]], along)
    mechanism.row(name, dot(mechanism.place(spec["height"]), along) - mechanism.number())
    return Drive(
        lambda value, _, exact: [value * exact(1 / unit) + exact(drawn)],
        lambda w: (w[0] - as_ball(drawn)) * as_ball(unit),
    )


def _contact(mechanism: Mechanism, name: str, spec: Mapping[str, Any]) -> Drive:
    """The height of the contact point; over the ground along the true vertical, which turns against the
    chassis.
    """
    inner, centre = spec["contact"]
    plain, table, unit, first = mechanism.plain, mechanism.table, mechanism.unit, mechanism.count
    up, r = directions(plain)["up"], Fraction(plain["wheel_radius"]) / unit
    axis = mechanism.drawn_line(f"inputs.{name}", inner, centre)
    l2, m, high = dot(axis, axis), dot(axis, up), dot(table[centre], up)
    share2, grounded = r * r / l2, spec.get("over") == "ground"
    seen, lift = (mechanism.number(), mechanism.number(), mechanism.number()), mechanism.number()

    def read(points: Table, _: Sequence[Scalar], exact: Exact, numbers: Sequence[Scalar]) -> list[Scalar]:
        a, b, c = numbers[first : first + 3]
        lean = dot(minus(points[centre], points[inner]), (a, b, c))
        return [lean, root(exact(r * r) - lean * lean * exact(share2))]

    lean, drop = mechanism.unknowns(2, read)
    mechanism.row(f"lean of {name}", lean - dot(minus(mechanism.place(centre), mechanism.place(inner)), seen))
    mechanism.row(f"contact of {name}", drop * drop + lean * lean * share2 - r * r)
    mechanism.row(name, dot(mechanism.place(centre), seen) + lift - drop - mechanism.number())

    def drawn(exact: Exact) -> Scalar:
        return exact(high) - root(exact(r * r - m * m * share2))

    def numbers(value: Jet, inputs: Mapping[str, Jet], exact: Exact) -> list[Jet]:
        chassis = ChassisMotion.of(plain if grounded else {"inputs": {}}, table, unit, inputs, exact)
        zero, upward = value * 0, each(exact, up)
        ground = (*chassis.turns.turned_back(upward), dot(chassis.moved((0, 0, 0)), upward))
        return [*(zero + x for x in ground), value * exact(1 / unit) + drawn(exact)]

    return Drive(numbers, lambda w: (w[4] - drawn(as_ball)) * as_ball(unit))


def _distance(mechanism: Mechanism, name: str, spec: Mapping[str, Any]) -> Drive:
    one, two = spec["distance"]
    unit, drawn = mechanism.unit, minus(mechanism.table[one], mechanism.table[two])
    apart, d2 = minus(mechanism.place(one), mechanism.place(two)), dot(drawn, drawn)
    mechanism.row(name, dot(apart, apart) - mechanism.number())
    return Drive(
        lambda value, _, exact: [value * value * exact(1 / unit**2)],
        lambda w: w[0].sqrt() * as_ball(unit),
        lambda: as_ball(d2).sqrt() * as_ball(unit),
    )


KINDS: dict[str, Callable[[Any, str, Mapping[str, Any]], Drive]] = {
    "angle": _angle,
    "travel": _travel,
    "steers": _travel,
    "height": _height,
    "contact": _contact,
    "distance": _distance,
}


def compiled(plain: Mapping[str, Any], table: Table, unit: Fraction, hangs: bool = True) -> Mechanism:
    """The equations of a description with its inputs, see `Mechanism`.

    Raises:
        NoReferenceError: points that must differ coincide, or a slide or an input is impossible.
    """
    mechanism = Mechanism(plain, table, unit, hangs)
    for name, spec in plain["inputs"].items():
        for kind in KINDS.keys() & spec.keys():
            mechanism.drives[name] = KINDS[kind](mechanism, name, spec)
            mechanism.driving[name] = len(mechanism.rows) - 1
    return mechanism
