"""Broken and odd scene files by number: the same number always gives the same file.

Each file starts as a built-in scene and is changed as text (bits, lines, numbers), as content (values,
points, inputs, times), or both; a few are TOML that never was a scene.
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

from pointcoord.scene.scene_file import MOST_SAMPLES
from validate.toml_written import key_of, value_of

Content = dict[str, Any]

# Named here, so that a further built-in scene does not change what a number means.
SCENES = (
    "bounce",
    "off-axis-strut",
    "bounce-and-steer",
    "double-wishbone",
    "bounce-on-a-heaving-chassis",
    "steer",
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


def mutated_scene(number: int) -> bytes:
    """The scene file of a number."""
    random = Random(number)
    name = SCENES[number % len(SCENES)]
    source = resources.files("pointcoord").joinpath("scenes", f"{name}.toml")
    text = source.read_text(encoding="utf-8")
    kind = random.choices(("content", "text", "both", "random"), (65, 20, 12, 3))[0]
    if kind == "random":
        return _written({word(random): anything(random, 4) for _ in range(random.randint(0, 6))}).encode()
    if kind != "text":
        content = tomllib.loads(text)
        for _ in range(random.choice((1, 1, 1, 1, 2, 3))):
            random.choice(CONTENT_CHANGES)(random, content)
        text = _written(content)
    data = text.encode("utf-8")
    if kind != "content":
        for _ in range(random.choice((1, 1, 2, 3))):
            data = random.choice(TEXT_CHANGES)(random, data)
    return _with_fewer_samples(data)


def mutated(data: bytes, number: int) -> bytes:
    """A file with one to four changes of its text."""
    random = Random(number)
    for _ in range(random.choice((1, 1, 1, 2, 4))):
        data = random.choice(TEXT_CHANGES)(random, data)
    return data


def _with_fewer_samples(data: bytes) -> bytes:
    try:
        samples = tomllib.loads(data.decode("utf-8"))["time"]["samples"]
    except (ValueError, KeyError, TypeError, RecursionError):
        return data
    if isinstance(samples, int) and MOST_INSTANTS < samples <= MOST_SAMPLES:
        return re.sub(rb'("?samples"?\s*=\s*)[\w+-]+', rb"\g<1>%d" % MOST_INSTANTS, data)
    return data


def _written(content: Content) -> str:
    """Content as TOML, every table inline."""
    return "".join(f"{key_of(key)} = {value_of(value)}\n" for key, value in content.items())


def _flip_bits(random: Random, data: bytes) -> bytes:
    changed = bytearray(data)
    for _ in range(random.choice((1, 1, 2, 8))):
        if changed:
            changed[random.randrange(len(changed))] ^= 1 << random.randrange(8)
    return bytes(changed)


def _other_lines(random: Random, data: bytes) -> bytes:
    lines = data.split(b"\n")
    one, two = random.randrange(len(lines)), random.randrange(len(lines))
    change = random.randrange(3)
    if change == 0:
        del lines[one]
    elif change == 1:
        lines.insert(one, lines[two])
    else:
        lines[one], lines[two] = lines[two], lines[one]
    return b"\n".join(lines)


def _other_bytes(random: Random, data: bytes) -> bytes:
    low = random.randrange(len(data) + 1)
    high = low + random.choice((0, 0, 1, 5, 100, len(data)))
    return (
        data[:low]
        + random.choice((b"", random.randbytes(random.randrange(6)), data[low:high] * 2))
        + data[high:]
    )


def _other_token(random: Random, data: bytes) -> bytes:
    text = data.decode("latin-1")
    found = list(NUMBER.finditer(text))
    if not found:
        return data
    place = random.choice(found)
    token = random.choice((*TOKENS, repr(size(random)), repr(size(random)), str(random.randint(-999, 999))))
    return (text[: place.start()] + token + text[place.end() :]).encode("latin-1")


TEXT_CHANGES: tuple[Callable[[Random, bytes], bytes], ...] = (
    *(_flip_bits, _other_lines, _other_bytes, _other_token, _other_token),
)


# Changes of content: values, points, inputs, times and settings

ODD: tuple[Any, ...] = (
    *(0, 1, -1, 0.0, -0.0, 0.5, 3.2, 2**53 + 1, 10**30, 10**400, -(10**400)),
    *(5e-324, 1e-300, 1e-12, 1e12, 1e100, -1e100, 1e154, 1e200, 1e308, -1e308, math.inf, -math.inf, math.nan),
    *(True, False, "", "0.8", "macpherson", "right", "\n\x1b\u2028", "x" * 300),
    *([], [[]], [0], [1, 2], [1, 2, 3], [1, 2, 3, 4], ["a", "b", "c"], {}, {"a": {}}, {"constant": 1.0}),
)


def _places(content: Any) -> list[tuple[Any, Any]]:
    """Every (container, key) in a content."""
    keys = content if isinstance(content, dict) else range(len(content)) if isinstance(content, list) else ()
    return [place for key in keys for place in ((content, key), *_places(content[key]))]


def _is_number(value: Any) -> bool:
    """Whether it is a number that a float can hold."""
    return type(value) in (int, float) and not abs(value) > sys.float_info.max


def _numbers(content: Any) -> list[tuple[Any, Any]]:
    return [(box, key) for box, key in _places(content) if _is_number(box[key])]


def word(random: Random) -> str:
    return random.choice(("title", "time", "inputs", "rack", "points", "a b", "", "ü", "\x07", "q" * 80))


def anything(random: Random, depth: int) -> Any:
    if depth and random.random() < 0.5:
        if random.random() < 0.5:
            return [anything(random, depth - 1) for _ in range(random.randint(0, 4))]
        return {word(random): anything(random, depth - 1) for _ in range(random.randint(0, 4))}
    return random.choice(ODD)


def size(random: Random) -> float:
    """A number of either sign: mostly of a sensible size, at times of any."""
    power = random.uniform(-2.0, 3.0) if random.random() < 0.8 else random.uniform(-300.0, 300.0)
    sign = random.choice((-1.0, 1.0, 1.0))
    return sign * math.pow(10.0, power)


def _odd_value(random: Random, content: Content) -> None:
    box, key = random.choice(_places(content) or [({"": 0}, "")])
    box[key] = copy.deepcopy(random.choice(ODD))


def _drop(random: Random, content: Content) -> None:
    box, key = random.choice(_places(content) or [({"": 0}, "")])
    del box[key]


def _add(random: Random, content: Content) -> None:
    tables = [box[key] for box, key in _places(content) if isinstance(box[key], dict)]
    random.choice([content, *tables])[word(random)] = anything(random, 2)


def _swap_values(random: Random, content: Content) -> None:
    numbers = _numbers(content)
    if len(numbers) > 1:
        (one, i), (two, k) = random.sample(numbers, 2)
        one[i], two[k] = two[k], one[i]


def _other_number(random: Random, content: Content) -> None:
    for box, key in random.sample(
        _numbers(content), min(len(_numbers(content)), random.choice((1, 1, 2, 5)))
    ):
        box[key] = random.choice((size(random), box[key] * size(random), -box[key], box[key] + size(random)))


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
    table |= random.choice(
        (
            {one: b, two: a},
            {one: list(b)},
            {one: [x + near * random.choice((-1, 0, 1)) for x in b]},
            {three: line},
            {three: [x + near for x in line]},
            {n: [0.0 if k == axis else x for k, x in enumerate(table[n])] for n in names},
            {n: [factor * x for x in table[n]] for n in names},
            {n: [x + factor for x in table[n]] for n in names},
            {n: [x + random.gauss(0.0, abs(factor)) for x in table[n]] for n in names},
            {n: [-x if k == axis else x for k, x in enumerate(table[n])] for n in names},
            {"wheel_axis_inner": [x + near * factor for x in b]},
        )
    )
    if random.random() < 0.1:
        table.pop("rack_centre", None)


def _input(random: Random, content: Content) -> None:
    """An input of another kind: constant, polynomial, sine or table, mostly of a sensible size."""
    time = _part(content, "time")
    ends = time.get("start"), time.get("stop")
    start, stop = (x if isinstance(x, float) and math.isfinite(x) else 1.0 for x in ends)
    name = random.choice(("arm_angle", "rack", "heave"))
    middle, swing = (random.uniform(0.9, 2.2), 0.2) if name == "arm_angle" else (0.0, 20.0)
    if random.random() < 0.2:
        middle, swing = size(random), abs(size(random))
    count = random.choice((0, 1, 3, 4, 4, 5, 10, 40, 100))
    times = [start + (stop - start) * k / max(count - 1, 1) for k in range(count)]
    if random.random() < 0.2:
        times = [t + random.gauss(0.0, 0.3) for t in times]
    elif random.random() < 0.3:
        times = sorted({start, *(random.uniform(start, stop) for _ in times), stop})
    share = random.choice((0.001, 0.1, 1.0))
    values = [random.gauss(middle, swing * share) for _ in times]
    powers = [random.gauss(0.0, swing) for _ in range(random.choice((0, 1, 1, 2, 3, 8, 40)))]
    # Up to a hundred radians per second: faster ones of a sensible size take honest minutes.
    speed = 0.1 * size(random)
    law: Content = random.choice(
        (
            {"constant": middle},
            {"polynomial": [middle, *powers]},
            {"sine": {"amplitude": swing, "angular_frequency": speed, "offset": middle}},
            {"sine": {"amplitude": swing, "angular_frequency": 1.0, "phase": speed, "offset": middle}},
            {"table": {"times": times, "values": values}},
            {"table": {"times": times, "values": values}},
        )
    )
    _part(content, "inputs")[name] = law


def _time(random: Random, content: Content) -> None:
    """Times reversed, huge, tiny, far away, zero; other numbers of samples."""
    time = _part(content, "time")
    start = random.choice((0.0, 0.1, -1.0, 1e6, 1e15, 1e300, -1e308, size(random)))
    span = random.choice((0.0, 5e-324, 1e-300, 1e-9, 0.3, 1.0, -1.0, 1e3, 1e6, 1e308, size(random)))
    samples = random.choice((-1, 0, 1, 1, 2, 3, 7, 1000, 20_000, MOST_SAMPLES + 1, 10**30))
    time |= random.choice(({"start": start, "stop": start + span}, {"stop": start + span}, {"start": start}))
    if random.random() < 0.6:
        time["samples"] = samples


def _settings(random: Random, content: Content) -> None:
    """Effects, tolerance, side and axes of the car."""
    known = ["velocity", "acceleration", "knuckle_rates", "wheel_angles"]
    turn = random.uniform(0.0, 2.0 * math.pi)
    c, s = math.cos(turn), math.sin(turn)
    content |= random.choice(
        (
            {"effects": random.choices(known, k=random.randrange(6))},
            {"effects": random.choices([*known, "camber", ""], k=2)},
            {"tolerance": 10.0 ** random.uniform(-320.0, 308.0)},
            {"tolerance": 10.0 ** random.uniform(-16.0, 3.0)},
        )
    )
    _part(content, "mechanism").update(
        random.choice(
            (
                {"side": random.choice(("left", "right", "Left"))},
                {"closure": random.choice(("drawn", "collinear", "Drawn"))},
                {"closure": random.choice(("drawn", "collinear"))},
                {"up": [0.0, -s, c], "right": [0.0, c, s]},
                {"up": [s, 0.0, c], "right": [0.0, 1.0, 0.0]},
                {"up": [-s, c, 0.0], "right": [c, s, 0.0]},
                {
                    "up": [0.0, -s, c * random.choice((1.0, 1.0 + 1e-13, 1.0 + 1e-9, 2.0))],
                    "right": [0.0, c, s],
                },
                {"up": [size(random) for _ in range(3)]},
            )
        )
    )


def _part(content: Content, *keys: str) -> Content:
    """A table in the content, or one that goes nowhere if an earlier change has taken it."""
    part: Any = content
    for key in keys:
        part = part.get(key) if isinstance(part, dict) else None
    return part if isinstance(part, dict) else {}


CONTENT_CHANGES: tuple[Callable[[Random, Content], None], ...] = (
    *(_odd_value, _odd_value, _drop, _add, _swap_values, _other_number, _other_number),
    *(_points, _points, _points, _input, _input, _input, _time, _time, _settings, _settings),
)
