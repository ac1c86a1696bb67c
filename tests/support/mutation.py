"""Broken and odd files by number: the same number always gives the same file.

A scene is changed as content (values, points, laws, times) and at times as text too, other files as text.
"""

from __future__ import annotations

import copy
import math
import re
import sys
import tomllib
from collections.abc import Callable
from importlib import resources
from random import Random
from typing import Any

from validate.toml_written import key_of, value_of

Content = dict[str, Any]

# Named here, so that a further built-in scene does not change what a number means.
SCENES = (
    "bounce",
    "off-axis-strut",
    "axle-roll",
    "double-wishbone",
    "bounce-on-a-heaving-chassis",
    "five-link",
)
# More instants than this take honest seconds to write, which would hide a hang.
MOST_INSTANTS = 20_000
# What a number of a file may be replaced by, as text that no writer of TOML would make.
TOKENS = (
    *("nan", "inf", "-inf", "1e999", "-1e308", "1e-320", "1_000", "0x10", "1" * 5000, "0x" + "f" * 5000),
    *("true", '"1"', "'''1\n'''", "[]", "{}", "[1]", "1979-05-27", "07:32:00", "", "--1", "1.", ".5", "1e"),
    *("[" * 400 + "]" * 400, "{ a = " * 300 + "1" + " }" * 300),
)
NUMBER = re.compile(r"[-+]?\d[\d_]*\.?\d*(?:e[-+]?\d+)?")
# What any value of a scene may be replaced by.
ODD: tuple[Any, ...] = (
    *(0, 1, -1, 0.0, -0.0, 0.5, 3.2, 2**53 + 1, 10**30, 10**400, -(10**400)),
    *(5e-324, 1e-300, 1e-12, 1e12, 1e100, -1e100, 1e154, 1e200, 1e308, -1e308, math.inf, -math.inf, math.nan),
    *(True, False, "", "0.8", "macpherson", "right", "\n\x1b\u2028", "x" * 300),
    *([], [[]], [0], [1, 2], [1, 2, 3], [1, 2, 3, 4], ["a", "b", "c"], {}, {"a": {}}, {"constant": 1.0}),
)


def mutated(data: bytes, number: int) -> bytes:
    """A file with one to four changes of its text."""
    random = Random(number)
    for _ in range(random.choice((1, 1, 1, 2, 4))):
        data = random.choice((_bits, _lines, _bytes, _token, _token))(random, data)
    return data


def mutated_scene(number: int) -> bytes:
    """The scene file of a number."""
    random = Random(number)
    name = SCENES[number % len(SCENES)]
    data = resources.files("pointcoord").joinpath("scenes", f"{name}.toml").read_bytes()
    as_text = random.random() < 0.2
    if not as_text:
        content = tomllib.loads(data.decode("utf-8"))
        for _ in range(random.choice((1, 1, 1, 1, 2, 3))):
            random.choice(CONTENT_CHANGES)(random, content)
        data = "".join(f"{key_of(key)} = {value_of(value)}\n" for key, value in content.items()).encode()
    if as_text or random.random() < 0.15:
        data = mutated(data, number)
    many = re.search(rb'"?samples"?\s*=\s*(\d+)\b', data)
    return data.replace(many[1], b"%d" % MOST_INSTANTS) if many and 4 < len(many[1]) < 9 else data


def _bits(random: Random, data: bytes) -> bytes:
    changed = bytearray(data)
    for _ in range(random.choice((1, 1, 2, 8))):
        if changed:
            changed[random.randrange(len(changed))] ^= 1 << random.randrange(8)
    return bytes(changed)


def _lines(random: Random, data: bytes) -> bytes:
    lines = data.split(b"\n")
    one, two = random.randrange(len(lines)), random.randrange(len(lines))
    lines[one : one + random.randrange(2)] = random.choice(([], [lines[two]]))
    return b"\n".join(lines)


def _bytes(random: Random, data: bytes) -> bytes:
    low = random.randrange(len(data) + 1)
    high = low + random.choice((0, 0, 1, 5, 100, len(data)))
    other = random.choice((b"", random.randbytes(random.randrange(6)), data[low:high] * 2))
    return data[:low] + other + data[high:]


def _token(random: Random, data: bytes) -> bytes:
    text = data.decode("latin-1")
    if not (found := list(NUMBER.finditer(text))):
        return data
    place = random.choice(found)
    token = random.choice((*TOKENS, repr(size(random)), repr(size(random)), str(random.randint(-999, 999))))
    return (text[: place.start()] + token + text[place.end() :]).encode("latin-1")


def size(random: Random) -> float:
    """A number of either sign: mostly of a sensible size, at times of any."""
    power = random.uniform(-2.0, 3.0) if random.random() < 0.8 else random.uniform(-300.0, 300.0)
    return random.choice((-1.0, 1.0, 1.0)) * 10.0**power


def _places(content: Any) -> list[tuple[Any, Any]]:
    """Every (container, key) in a content."""
    keys = content if isinstance(content, dict) else range(len(content)) if isinstance(content, list) else ()
    return [place for key in keys for place in ((content, key), *_places(content[key]))]


def _is_number(value: Any) -> bool:
    """Whether it is a number that a float can hold."""
    return type(value) in (int, float) and not abs(value) > sys.float_info.max


def _odd_value(random: Random, content: Content) -> None:
    box, key = random.choice(_places(content))
    box[key] = copy.deepcopy(random.choice(ODD))


def _drop(random: Random, content: Content) -> None:
    box, key = random.choice(_places(content))
    del box[key]


def _numbers(random: Random, content: Content) -> None:
    """Some numbers scaled, negated, moved, made of any size or swapped with another."""
    numbers = [(box, key) for box, key in _places(content) if _is_number(box[key])]
    for box, key in random.sample(numbers, min(len(numbers), random.choice((1, 1, 2, 5)))):
        other, at = random.choice(numbers)
        goal = random.choice((size(random), box[key] * size(random), -box[key], box[key] + size(random)))
        if random.random() < 0.2:
            goal, other[at] = other[at], box[key]
        box[key] = goal


def _points(random: Random, content: Content) -> None:
    """Points swapped, made equal, nearly equal, collinear or given by choice; all flat, scaled or moved."""
    table = _part(content, "mechanism", "points")
    names = [n for n, p in table.items() if isinstance(p, list) and len(p) == 3 and all(map(_is_number, p))]
    if len(names) < 3:
        return
    one, two, three = random.sample(names, 3)
    a, b = table[one], table[two]
    share, factor, axis = random.choice((0.5, 2.0, -1.0, random.random())), size(random), random.randrange(3)
    line = [x + share * (y - x) for x, y in zip(a, b, strict=True)]
    near = 10.0 ** random.uniform(-16.0, -1.0)
    every: list[Callable[[int, float], float]] = [
        lambda k, x: 0.0 if k == axis else x,
        lambda k, x: factor * x,
        lambda k, x: x + factor,
        lambda k, x: x + random.gauss(0.0, abs(factor)),
        lambda k, x: -x if k == axis else x,
    ]
    moved = [{n: [move(k, x) for k, x in enumerate(table[n])] for n in names} for move in every]
    close = [x + near * random.choice((-1, 0, 1)) for x in b]
    some = ({one: b, two: a}, {one: list(b)}, {one: close}, {three: line}, {three: [x + near for x in line]})
    table |= random.choice((*some, *moved))
    if random.random() < 0.1:
        table.pop("rack_centre", None)


def _law(random: Random, content: Content) -> None:
    """An input of another kind, mostly of a sensible size."""
    inputs, time = _part(content, "inputs"), _part(content, "time")
    ends = time.get("start"), time.get("stop")
    start, stop = (x if isinstance(x, float) and math.isfinite(x) else 1.0 for x in ends)
    name = random.choice([*inputs, "heave"])
    middle, swing = (random.uniform(0.9, 2.2), 0.2) if name == "arm_angle" else (0.0, 20.0)
    if random.random() < 0.2:
        middle, swing = size(random), abs(size(random))
    count = random.choice((0, 1, 3, 4, 4, 5, 10, 40, 100))
    times = [start + (stop - start) * k / max(count - 1, 1) for k in range(count)]
    if random.random() < 0.5:
        times = sorted({start, *(random.uniform(start, stop) for _ in times), stop})
    values = [random.gauss(middle, swing * random.choice((0.001, 0.1, 1.0))) for _ in times]
    powers = [random.gauss(0.0, swing) for _ in range(random.choice((0, 1, 1, 2, 3, 8, 40)))]
    # Up to a hundred radians per second: faster ones of a sensible size take honest minutes.
    speed, phase = random.choice(((0.1 * size(random), 0.0), (1.0, size(random))))
    sine = {"amplitude": swing, "angular_frequency": speed, "phase": phase, "offset": middle}
    table = {"table": {"times": times, "values": values}}
    inputs[name] = random.choice(
        ({"constant": middle}, {"polynomial": [middle, *powers]}, {"sine": sine}, table)
    )


def _time(random: Random, content: Content) -> None:
    """Times reversed, huge, tiny, far away, zero; other numbers of samples."""
    time = _part(content, "time")
    start = random.choice((0.0, 0.1, -1.0, 1e6, 1e15, 1e300, -1e308, size(random)))
    span = random.choice((0.0, 5e-324, 1e-300, 1e-9, 0.3, 1.0, -1.0, 1e3, 1e6, 1e308, size(random)))
    time |= {"start": start, "stop": start + span, "samples": random.choice((-1, 0, 1, 2, 7, 1000, 10**30))}


def _axes(random: Random, content: Content) -> None:
    """A car that stands on its side or its head, or whose axes are not quite at right angles."""
    turn, off = random.uniform(0.0, 2.0 * math.pi), random.choice((1.0, 1.0, 1.0 + 1e-13, 1.0 + 1e-9, 2.0))
    c, s = math.cos(turn), math.sin(turn)
    ways = (([0.0, -s, c * off], [0.0, c, s]), ([s, 0.0, c], [0.0, off, 0.0]), ([-s, c, 0.0], [c, s, 0.0]))
    up, right = random.choice(ways)
    _part(content, "mechanism").update(up=up, right=right, side=random.choice(("left", "right")))


def _part(content: Content, *keys: str) -> Content:
    """A table in the content, or one that goes nowhere if an earlier change has taken it."""
    part: Any = content
    for key in keys:
        part = part.get(key) if isinstance(part, dict) else None
    return part if isinstance(part, dict) else {}


CONTENT_CHANGES = (
    *(_odd_value, _odd_value, _drop, _numbers, _numbers, _axes),
    *(_points, _points, _points, _law, _law, _law, _time, _time),
)
