r"""Kinds of input: the rows that say them, the numbers w that these take, and where the drawing has them.

    angle from a direction    (P - Q) . direction = w,          w = d cos(theta), d as drawn
    angle from the drawing    g1 w1 - g2 w2 = 0,                w1 = sin(theta), w2 = cos(theta) / |n|,
                              g1 = R e . R' e,  g2 = R e . R' (n x e),  n along the hinge, e across it
    travel of a slide         s = w                             w = travel / length of the slide's line
    turn of a steering wheel  s = w                             travel = rack_per_turn angle / (2 pi)
    height of a point         P . direction = w
    contact height            (centre - s up) . direction = w,  s^2 + (r m / l)^2 = r^2,
                              m = (centre - inner) . up, l their distance, r the wheel's radius
    the same over the ground  centre . g + w4 - s = w5,  m = (centre - inner) . g,  g = (w1, w2, w3) and w4
                              such that a place p of the chassis is p . g + w4 high when the car is moved
    distance of two points    |P - Q|^2 = w,                    w = distance^2

All lengths are local (see `design`), and so is the drawing.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from functools import partial
from typing import Any

from flint import arb

from validate.reference.car_data import directed
from validate.reference.chassis import ChassisMotion
from validate.reference.errors import BadInputError
from validate.reference.exact import as_ball, as_fraction
from validate.reference.jet import Jet, angle
from validate.reference.mechanism import CHASSIS, Drive, Exact, Mechanism, Table
from validate.reference.polynomial import Polynomial
from validate.reference.vectors import Scalar, across, cross, dot, each, minus, root


def drive_of(mechanism: Mechanism, name: str, spec: Mapping[str, Any]) -> Drive:
    """The drive that a description's input is; its rows go to the mechanism, the one with the numbers last.

    Raises:
        BadInputError: there is no such kind of input, or it cannot drive the car as drawn.
    """
    for kind, make in KINDS.items():
        if kind in spec:
            return make(mechanism, name, spec)
    raise BadInputError(f"inputs.{name}", dict(spec), f"one of {', '.join(KINDS)}, moves or turns")


def _angle(mechanism: Mechanism, name: str, spec: Mapping[str, Any]) -> Drive:
    if spec["from"] == "drawing":
        return _angle_from_drawing(mechanism, name, spec)
    end, pivot = spec["of"], spec["about"]
    along = directed(mechanism.plain, spec["from"])
    drawn = minus(mechanism.table[end], mechanism.table[pivot])
    d2, height = dot(drawn, drawn), dot(drawn, along)
    if d2 == 0:
        raise BadInputError(f"the distance from {end} to {pivot}", 0, "more than 0")
    mechanism.row(name, dot(minus(mechanism.place(end), mechanism.place(pivot)), along) - mechanism.number())

    def angle(numbers: Sequence[arb]) -> arb:
        # By cosine and sine: an arc cosine loses its digits where the arm stands along the direction. That is
        # a unit vector to rounding only, so the difference may be just below zero.
        beside = (as_ball(d2) - numbers[0] * numbers[0]).nonnegative_part()
        return arb.atan2(beside.sqrt(), numbers[0])

    def numbers(value: Jet, exact: Exact) -> list[Jet]:
        return [value.sin_cos()[1] * root(exact(d2))]

    return _own(name, numbers, lambda: [as_ball(height)], angle)


def _angle_from_drawing(mechanism: Mechanism, name: str, spec: Mapping[str, Any]) -> Drive:
    body, on, table = spec["angle"], spec["on"], mechanism.table
    both = [point for point in mechanism.plain["bodies"][body] if point in mechanism.plain["bodies"][on]]
    if len(both) != 2:
        raise BadInputError(f"inputs.{name}: angle", body, f"a body hinged on {on}")
    n = minus(table[both[1]], table[both[0]])
    e, nn = across(n)[0], dot(n, n)
    turning, held = mechanism.bodies[body].turned(e), mechanism.bodies[on]
    products = [dot(turning, held.turned(v)) for v in (e, cross(n, e))]
    if on != CHASSIS:  # each is quadratic itself, and so an unknown
        for i, product in enumerate(tuple(products)):
            (products[i],) = mechanism.unknowns(1, partial(_of_unknowns, product))
            mechanism.row(name, products[i] - product)
    sine, cosine = mechanism.number(), mechanism.number()
    mechanism.row(name, products[0] * sine - products[1] * cosine)
    # At the angle itself g1 cos + g2 sin / |n| is positive; half a turn from it negative.
    mechanism.positive.append(products[0] * cosine * nn + products[1] * sine)

    def numbers(value: Jet, exact: Exact) -> list[Jet]:
        sin, cos = value.sin_cos()
        return [sin, cos * (1 / root(exact(nn)))]

    return _own(
        name,
        numbers,
        lambda: [arb(0), 1 / as_ball(nn).sqrt()],
        lambda w: arb.atan2(w[0], w[1] * as_ball(nn).sqrt()),
        turns=True,
    )


def _of_unknowns(
    one: Polynomial, _: Table, unknown: Sequence[Scalar], exact: Exact, *__: object
) -> list[Scalar]:
    return [one.at(unknown, exact)]


def _travel(mechanism: Mechanism, name: str, spec: Mapping[str, Any]) -> Drive:
    return _slid(mechanism, name, spec["travel"], lambda exact: exact(Fraction(1)))


def _steers(mechanism: Mechanism, name: str, spec: Mapping[str, Any]) -> Drive:
    given = mechanism.plain.get("rack_per_turn")
    if given is None:
        raise BadInputError("rack_per_turn", None, f"a number of mm, which inputs.{name} needs")
    return _slid(mechanism, name, spec["steers"], partial(travel_per_radian, mechanism.plain))


def travel_per_radian(plain: Mapping[str, Any], exact: Exact = as_ball) -> Scalar:
    """What a rack goes as the steering wheel turns, rack_per_turn / (2 pi), mm, in a kind of number.

    Raises:
        BadInputError: rack_per_turn is no number other than 0.
    """
    per_turn = as_fraction(plain["rack_per_turn"], "rack_per_turn")
    if per_turn == 0:
        raise BadInputError("rack_per_turn", plain["rack_per_turn"], "a number of mm other than 0")
    quarter = angle(exact(Fraction(1)), exact(Fraction(0)))
    return exact(per_turn) / (4 * quarter)


def _slid(
    mechanism: Mechanism, name: str, slides: Sequence[str], per_input: Callable[[Exact], Scalar]
) -> Drive:
    """Slides that go `per_input` mm per mm or rad of the input."""
    drawn, lengths, unit = [], [], mechanism.unit
    for slide in slides:
        shares, along, squared = mechanism.lines[slide]
        mechanism.row(name, shares[0] - mechanism.number())
        told = mechanism.plain["slides"][slide]
        off = minus(mechanism.table[told["points"][0]], mechanism.table[told["through"]])
        drawn.append(dot(off, along) / dot(along, along))
        lengths.append(squared)
    per_input(as_ball)  # what it refuses is refused here

    def numbers(value: Jet, exact: Exact) -> list[Jet]:
        local = value * (per_input(exact) * exact(1 / unit))
        return [local * (1 / root(exact(squared))) for squared in lengths]

    return _own(
        name,
        numbers,
        lambda: [as_ball(one) for one in drawn],
        lambda w: w[0] * as_ball(unit) * as_ball(lengths[0]).sqrt() / per_input(as_ball),
        required=False,
    )


def _height(mechanism: Mechanism, name: str, spec: Mapping[str, Any]) -> Drive:
    along = directed(mechanism.plain, spec.get("along", "up"))
    drawn = dot(mechanism.table[spec["height"]], along)
    mechanism.row(name, dot(mechanism.place(spec["height"]), along) - mechanism.number())
    return _risen(name, mechanism.unit, lambda exact: exact(drawn))


def _contact(mechanism: Mechanism, name: str, spec: Mapping[str, Any]) -> Drive:
    inner, centre = spec["contact"]
    radius = mechanism.plain.get("wheel_radius")
    if radius is None:
        raise BadInputError("wheel_radius", None, f"a number of mm, which inputs.{name} needs")
    up, r = directed(mechanism.plain, "up"), Fraction(radius) / mechanism.unit
    axis = minus(mechanism.table[centre], mechanism.table[inner])
    l2, m, high = dot(axis, axis), dot(axis, up), dot(mechanism.table[centre], up)
    if l2 == 0:
        raise BadInputError(f"the distance from {inner} to {centre}", 0, "more than 0")
    share2 = r * r / l2

    over = spec.get("over", CHASSIS)
    if over not in (CHASSIS, "ground"):
        raise BadInputError(f"inputs.{name}: over", over, "'chassis' or 'ground'")

    def drawn(exact: Exact) -> Scalar:
        return exact(high) - root(exact(r * r - m * m * share2))

    if over == "ground":
        return _over_ground(mechanism, name, (inner, centre), (r * r, share2), drawn)

    def read(points: Table, _: Sequence[Scalar], exact: Exact, *__: object) -> list[Scalar]:
        lean = dot(minus(points[centre], points[inner]), each(exact, up))
        return [root(exact(r * r) - lean * lean * exact(share2))]

    (drop,) = mechanism.unknowns(1, read)
    mechanism.positive.append(drop)
    lean = dot(minus(mechanism.place(centre), mechanism.place(inner)), up)
    if isinstance(lean, Polynomial):
        mechanism.row(f"contact of {name}", drop * drop + lean * lean * share2 - r * r)
    mechanism.row(name, dot(mechanism.place(centre), up) - drop - mechanism.number())
    return _risen(name, mechanism.unit, drawn)


def _over_ground(
    mechanism: Mechanism,
    name: str,
    axis: tuple[str, str],
    disc: tuple[Fraction, Fraction],
    drawn: Callable[[Exact], Scalar],
) -> Drive:
    """A contact height along the true up, which the chassis' inputs turn in the chassis' frame.

    Args:
        disc: r^2 and (r / l)^2.
    """
    (inner, centre), (square, share) = axis, disc
    up, plain, first = directed(mechanism.plain, "up"), mechanism.plain, mechanism.count
    x, y, z, lift, level = (mechanism.number() for _ in range(5))
    seen = (x, y, z)

    def read(points: Table, _: Sequence[Scalar], exact: Exact, numbers: Sequence[Scalar]) -> list[Scalar]:
        a, b, c = numbers[first : first + 3]
        lean = dot(minus(points[centre], points[inner]), (a, b, c))
        return [lean, root(exact(square) - lean * lean * exact(share))]

    lean, drop = mechanism.unknowns(2, read)
    mechanism.positive.append(drop)
    mechanism.row(f"lean of {name}", lean - dot(minus(mechanism.place(centre), mechanism.place(inner)), seen))
    mechanism.row(f"contact of {name}", drop * drop + lean * lean * share - square)
    mechanism.row(name, dot(mechanism.place(centre), seen) + lift - drop - level)

    def numbers(inputs: Mapping[str, Jet], exact: Exact) -> list[Jet]:
        chassis = ChassisMotion.of(plain, mechanism.table, mechanism.unit, inputs, exact)
        zero = inputs[name] * 0
        nowhere, upward = (zero, zero, zero), each(exact, up)
        ways = ([zero + int(i == k) for i in range(3)] for k in range(3))
        ground = [zero + dot(chassis.turned((a, b, c)), upward) for a, b, c in ways]
        risen = inputs[name] * exact(1 / mechanism.unit) + drawn(exact)
        return [*ground, zero + dot(chassis.moved(nowhere), upward), risen]

    return Drive(
        numbers,
        lambda: [*each(as_ball, up), arb(0), drawn(as_ball)],
        lambda w: (w[4] - drawn(as_ball)) * as_ball(mechanism.unit),
    )


def _own(
    name: str,
    numbers: Callable[[Jet, Exact], Sequence[Jet]],
    drawn: Callable[[], Sequence[arb]],
    input_of: Callable[[Sequence[arb]], arb],
    required: bool = True,
    turns: bool = False,
) -> Drive:
    """An input whose numbers hang on its own value alone."""
    return Drive(lambda inputs, exact: numbers(inputs[name], exact), drawn, input_of, required, turns)


def _risen(name: str, unit: Fraction, drawn: Callable[[Exact], Scalar]) -> Drive:
    """An input that counts, in mm, from the drawing on."""
    return _own(
        name,
        lambda value, exact: [value * exact(1 / unit) + drawn(exact)],
        lambda: [drawn(as_ball)],
        lambda w: (w[0] - drawn(as_ball)) * as_ball(unit),
    )


def _distance(mechanism: Mechanism, name: str, spec: Mapping[str, Any]) -> Drive:
    one, two = spec["distance"]
    unit, drawn = mechanism.unit, minus(mechanism.table[one], mechanism.table[two])
    apart, d2 = minus(mechanism.place(one), mechanism.place(two)), dot(drawn, drawn)
    mechanism.row(name, dot(apart, apart) - mechanism.number())
    return _own(
        name,
        lambda value, exact: [value * value * exact(1 / unit**2)],
        lambda: [as_ball(d2)],
        lambda w: w[0].sqrt() * as_ball(unit),
    )


KINDS: dict[str, Callable[[Any, str, Mapping[str, Any]], Drive]] = {
    "angle": _angle,
    "travel": _travel,
    "steers": _steers,
    "height": _height,
    "contact": _contact,
    "distance": _distance,
}


def compiled(plain: Mapping[str, Any], table: Table, unit: Fraction, hangs: bool = True) -> Mechanism:
    """The equations of a description with its inputs, see `Mechanism`.

    Raises:
        BadInputError: something in the description cannot be.
    """
    mechanism = Mechanism(plain, table, unit, hangs)
    for name, spec in plain["inputs"].items():
        if "moves" not in spec and "turns" not in spec:
            mechanism.drives[name] = drive_of(mechanism, name, spec)
            mechanism.driving[name] = len(mechanism.rows) - 1
    for name in table:
        if name not in mechanism.holder and name not in mechanism.free:
            raise BadInputError(f"points.{name}", "in no body, rod or slide", "a point of one of them")
    return mechanism
