"""Broken and odd scene files by number: the same number always gives the same file.

Each file starts as a built-in scene and is changed as text (bits, lines, numbers), as content (values,
points, inputs, times), or both; a few are TOML that never was a scene.
"""

from __future__ import annotations

import json
import re
import tomllib
from collections.abc import Callable
from importlib import resources
from random import Random
from typing import Any

from mutated_content import CONTENT_CHANGES, Content, anything, size, word

from pointcoord.scene.scene_file import MOST_SAMPLES

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
    return "".join(f"{json.dumps(key)} = {_value(value)}\n" for key, value in content.items())


def _value(value: Any) -> str:
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{json.dumps(key)} = {_value(item)}" for key, item in value.items()) + " }"
    if isinstance(value, list):
        return "[" + ", ".join(map(_value, value)) + "]"
    if isinstance(value, bool | str):
        return json.dumps(value)
    return repr(value)


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
