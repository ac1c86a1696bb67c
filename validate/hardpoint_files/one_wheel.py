"""One wheel in the axes and unit of a scene: converts its points, and finds those that follow from them.

Choices of the user are used even if they look wrong; the scene then gives warnings. Static angles printed in
the file are compared with those of the drawing: a misread name, a wrong side or a reversed axis shows as a
difference.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from decimal import Decimal
from math import degrees, dist, radians, tan

import numpy as np

from validate.hardpoint_files.contents import ALLOWED, DIRECTIONS, OUR_AXES, Axes, Point, plain, short
from validate.hardpoint_files.identified import SIDES, Wheel, missing
from validate.hardpoint_files.written_scene import Drawing
from validate.plain_text import some_of
from validate.tables.errors import FileError
from validate.tables.units import LENGTHS

# Limits of the extent of one wheel's suspension, from model cars to lorries, mm.
SMALLEST, LARGEST = Decimal(150), Decimal(4000)
# Distance from the wheel centre of the inner point of a spin axis that is given by its direction, mm.
INWARD = 100.0
# A coordinate of this point is rounded to 1e-12 mm, which changes the direction of the axis by 1e-14 rad.
DIGITS = Decimal("1e-12")
# Largest number of points named in a message.
NAMED = 12


def drawing_of(wheel: Wheel) -> Drawing:
    """The wheel's points in the order of its mechanism, and points that follow from them.

    Raises:
        FileError: the file lacks something that is needed, or its points contradict it.
        UsageError: the axes of the user are not valid.
    """
    file, structure = wheel.file, wheel.structure
    if not (structure.role("wheel_axis") and structure.role("inboard")):
        problem = f"is read as {wheel.kind}, whose mechanism file lacks the roles wheel_axis and inboard"
        raise file.refuse(problem, "a suspension of one wheel; for others write a scene (pointcoord new)")
    found = {name: replace(point, name=name) for name, point in wheel.ours.items()}
    found |= _on_slides(wheel)
    spin, (inner, centre) = _spin_axis(wheel), structure.role("wheel_axis")
    if lost := missing(wheel.kind, {*found} | ({inner} if spin and centre in found else set())):
        raise _lacks(wheel, lost)
    (axes, axes_by), (unit, unit_by) = _axes(wheel), _unit(wheel)
    found = {name: replace(point, place=axes.to_scene(point.place, unit)) for name, point in found.items()}
    side = _side(wheel, axes, found)
    if spin:
        step = np.array([spin[0], -1.0 if side == "right" else 1.0, -spin[1]])
        steps = zip(found[centre].place, (INWARD / np.linalg.norm(step) * step).tolist(), strict=True)
        x, y, z = (at + Decimal(part).quantize(DIGITS) for at, part in steps)
        angles = f"--camber {file.choices.camber:g} and --toe {file.choices.toe:g}"
        how = f"from {centre}: {INWARD:g} mm inboard on the spin axis, by {angles}, deg"
        found[inner] = Point(inner, (x, y, z), how)
    facts = [
        f"the file's axes are {axes.words}, by {axes_by}, in {unit}, by {unit_by}; "
        "here x rearward, y right, z up, in mm",
        *([] if np.linalg.det(axes.matrix) > 0 else ["these axes are left-handed: is one of them reversed?"]),
        *file.format.notes.get("", ()),
        *file.format.notes.get(wheel.kind, ()),
    ]
    points = [found[name] for name in structure.points if name in found]
    if file.choices.mirror:
        facts.append(f"the file has the {side} wheel; here it is mirrored to the other side of the car")
        side = SIDES[side == "left"]
        points = [replace(one, place=(one.place[0], -one.place[1] + 0, one.place[2])) for one in points]
    for name, other in structure.stand_ins.items():
        facts += [f"{name} is not in the file: {other} is used instead"] if name not in found else []
    return Drawing(file.source, wheel.kind, side, tuple(points), tuple(facts), wheel.others)


def _on_slides(wheel: Wheel) -> dict[str, Point]:
    """Missing points that may be anywhere on a slide's line, which another of its points defines."""
    found, there = dict[str, Point](), wheel.ours
    for slide in wheel.structure.slides.values():
        ends = slide.along, slide.through
        if slide.along in slide.points and there.keys() >= {*ends}:
            x, y, z = ((a + b) / 2 for a, b in zip(*(there[end].place for end in ends), strict=True))
            how = f"from {' and '.join(ends)}: halfway between them, as only their line matters"
            found |= {name: Point(name, (x, y, z), how) for name in slide.points if name not in there}
    return found


def _spin_axis(wheel: Wheel) -> tuple[float, float] | None:
    """The spin axis by --camber and --toe: how far it goes forward and up per unit outboard."""
    choices, inner = wheel.file.choices, wheel.structure.role("wheel_axis")[0]
    camber, toe = choices.camber, choices.toe
    if camber is None and toe is None:
        return None
    if inner in wheel.ours:
        problem = f"gives the direction of its spin axis by {inner}"
        raise wheel.file.refuse(problem, "neither --camber nor --toe")
    if camber is None or toe is None or not max(abs(camber), abs(toe)) < 45.0:
        allowed = "both --camber and --toe, each of less than 45 deg, or neither"
        raise wheel.file.refuse(f"is given --camber {camber} and --toe {toe}", allowed)
    return tan(radians(toe)), -tan(radians(camber))


def _lacks(wheel: Wheel, lost: list[str]) -> FileError:
    """The error of a file that lacks points that are needed and do not follow from others."""
    names = wheel.file.format.names_of(wheel.kind)
    looked = (f"{name} (looked for: {', '.join(map(short, names[name]))})" for name in lost)
    problem = f"lacks {', '.join(looked)} of a {wheel.kind}"
    if wheel.others:
        problem += f"; not recognised: {some_of(wheel.others, NAMED)}"
    advice = f'a file of names (--names; a new one is written) with {lost[0]} = "its name"'
    advice += f" or {lost[0]} = [x, y, z]"
    if wheel.structure.role("wheel_axis")[0] in lost:
        advice += "; for the spin axis you may give --camber and --toe, + leaning out at the top and + toe in"
    return wheel.file.refuse(problem, advice)


# Axes, unit and side, and checks of them.


def _axes(wheel: Wheel) -> tuple[Axes, str]:
    """The axes and their source: the user, the names of points or the format.

    Refused if the points contradict them, unless the user gives them: from the roles of some pairs of points
    it is known how they lie in the car. No point shows the direction to the left, which determines the
    wheel's side.
    """
    file, structure = wheel.file, wheel.structure
    if file.choices.axes is not None:
        return Axes.of(file.choices.axes), "--axes"
    lie: list[str] = []
    seen: dict[str, tuple[int, int]] = {}
    roles = {"forward": structure.role("front_and_rear"), "up": structure.role("steering_axis")[::-1]}
    for way, (one, other) in ((way, ends) for way, ends in roles.items() if ends):
        apart = [a - b for a, b in zip(wheel.ours[one].place, wheel.ours[other].place, strict=True)]
        most = max(range(3), key=lambda axis: abs(apart[axis]))
        seen[way] = most, 1 if apart[most] > 0 else -1
        lie.append(f"{one} lies along {'-+'[apart[most] > 0]}{'xyz'[most]} from {other}")
    names = {ours: point.name for ours, point in wheel.ours.items() if ours not in file.own.points}
    found: list[tuple[Axes, str]] = []
    for pattern, axes in file.format.axes.items():
        telling = [name for name in names.values() if re.fullmatch(pattern or ".*", plain(name))]
        if telling:
            found.append((axes, f"names such as {short(telling[0])}" if pattern else "its format"))
    if all(ours in theirs for ours, theirs in names.items()):
        found.append((OUR_AXES, "its points' names, which are ours"))
    if not found:
        where = f", where {' and '.join(lie)}" if lie else ""
        raise file.refuse("does not give the directions of x, y and z", f"--axes with {ALLOWED}{where}")
    axes, by = found[0]
    if any((axes.matrix[:, axis] * sign != DIRECTIONS[way]).any() for way, (axis, sign) in seen.items()):
        right = f"--axes {','.join(axes.directions)} if they are right"
        problem = f"has axes {axes.words} by {by}, but {' and '.join(lie)}"
        raise file.refuse(problem, f"--axes with the right directions, or {right}")
    return axes, by


def _unit(wheel: Wheel) -> tuple[str, str]:
    """The unit of lengths and its source; refused if the points do not have the size of a car in it."""
    file, given, chosen = wheel.file, wheel.file.contents.unit, wheel.file.choices.unit
    if given and chosen and given != chosen:
        raise file.refuse(f"states that its lengths are in {given}", f"--unit {given}, or no --unit")
    by = {"--unit": chosen, "the file": given, "its format": file.format.unit}
    who, unit = next((who, unit) for who, unit in by.items() if unit)
    if unit not in LENGTHS:
        allowed = f"--unit with one of {', '.join(LENGTHS)}"
        raise file.refuse(f"has lengths in {short(unit)}, by {who}", allowed)
    columns = zip(*(point.place for point in wheel.ours.values()), strict=True)
    span = max(max(column) - min(column) for column in columns)
    fitting = {name: span * size for name, size in LENGTHS.items() if SMALLEST <= span * size <= LARGEST}
    if unit not in fitting and chosen is None:
        problem = f"spans {float(span * LENGTHS[unit]):.4g} mm if its lengths are in {unit}"
        others = (f"--unit {other} makes {float(size):.4g} mm" for other, size in fitting.items())
        raise file.refuse(problem, "; ".join(others) or f"--unit {unit} if this is right")
    return unit, who


def _side(wheel: Wheel, axes: Axes, found: Mapping[str, Point]) -> str:
    """The wheel's side, from its position; it must be the side that the file or the user gives."""
    file, (_, centre), (inner,) = wheel.file, *map(wheel.structure.role, ("wheel_axis", "inboard"))
    lies = found[centre].place[1]
    out = lies - found[inner].place[1]
    if not out:
        raise file.refuse(f"has {centre} as far out as {inner}", "a wheel outboard of it; see --axes")
    seen = SIDES[out > 0]
    where = f"{centre} lies {abs(out):.6g} mm to the {seen} of {inner}"
    said_by = {"--side": file.choices.side, "the file": wheel.side}
    for by, said in said_by.items():
        if said and said != seen:
            allowed = (
                f"--axes with left and right exchanged in {','.join(axes.directions)}, or the {seen} side"
            )
            # Not offered if the file has the requested wheel: the other wheel, mirrored, may differ.
            if by == "--side" and wheel.side != said:
                allowed += f"; or --side {seen} --mirror makes the {said} wheel of it"
            raise file.refuse(f"has a {said} wheel by {by}, but {where}", allowed)
    if (lies > 0) != (out > 0) and not any(said_by.values()):
        problem = f"has {where}, but {abs(lies):.6g} mm to the {SIDES[lies > 0]} of the middle of the car"
        raise file.refuse(problem, f"--side {seen} if y is not counted from the middle, or other --axes")
    return seen


# Static angles.


@dataclass(frozen=True)
class AngleCheck:
    """An angle that the file prints and the imported drawing has, deg.

    Attributes:
        name: our name of the angle.
        words, line: its name in the file, and the line.
        printed, drawn: the value in the file, and that of the drawing.
        tolerance: from the printed digits of the angle and of the points.
    """

    name: str
    words: str
    line: int
    printed: float
    drawn: float
    tolerance: float

    @property
    def verdict(self) -> str:
        """`agrees` or `disagrees`."""
        return "agrees" if abs(self.printed - self.drawn) <= self.tolerance else "disagrees"


def angle_checks(wheel: Wheel, drawn: Mapping[str, float]) -> Iterator[AngleCheck]:
    """Compare the static angles printed in the file with those of the drawing.

    The digits of the points limit the accuracy of an axis. Half a digit h in both coordinates of both ends
    moves them apart by 2 sqrt(2) h in the plane of an angle. An axis of length L within 45 deg of this plane
    has a projected length of at least L / sqrt(2). So the angle changes by at most 4 h / L.

    Args:
        drawn: angles of the drawing by our names, rad.
    """
    left_open = 0.0
    for ends in map(wheel.structure.role, ("wheel_axis", "steering_axis")):
        if ends and {*ends} <= wheel.ours.keys():
            one, other = (wheel.ours[name].place for name in ends)
            half, length = max(map(_half_a_digit, (*one, *other))), dist(one, other)
            left_open = max(left_open, 4.0 * half / length if length else 0.0)
    angles = wheel.file.contents.angles
    for name, pattern in wheel.file.format.angles.items():
        for words, (value, line) in angles.get(wheel.part, angles.get("", {})).items():
            if name in drawn and re.match(pattern, words):
                off = _half_a_digit(value) + degrees(left_open)
                yield AngleCheck(name, words, line, float(value), degrees(drawn[name]), off)


def _half_a_digit(number: Decimal) -> float:
    return 0.5 * 10.0 ** int(number.as_tuple().exponent)
