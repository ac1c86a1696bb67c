"""Every way into a scene is checked, ends, and shows what a user called things as text."""

import copy
import io
import json
import os
import pickle
import socket
from collections.abc import Callable
from decimal import Decimal
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mechanism_files import scene_text
from pydantic import ValidationError

from pointcoord import PointcoordError, Scene, SceneError, simulate
from pointcoord.errors import visible
from pointcoord.results.even_instants import even_instants
from pointcoord.simulation import TRUNCATION_SHARE, scene_mechanism
from pointcoord.solve.step_rule import COARSEST, FINEST
from pointcoord.toml_text import LARGEST, read_stream

BOUNCE = Scene.load("bounce")
CONTENT = BOUNCE.model_dump(exclude_none=True)
plain = settings(deadline=None)
# Red, the start of a line, a turned line, no width at all, a line that is none, half a character, no end.
STEERING = "\x1b[31m\r\n\u202etxt\u200b\u2028\udc80" + 10_000 * "x"


@pytest.mark.parametrize("bad", [float("nan"), 0.0, "small", None, True])
def test_no_public_way_leads_to_a_scene_of_a_meaningless_tolerance(bad: Any) -> None:
    ways: tuple[Callable[[], object], ...] = (
        lambda: Scene.from_mapping({**CONTENT, "tolerance": bad}),
        lambda: BOUNCE.model_copy(update={"tolerance": bad}),
        lambda: BOUNCE.model_copy(update={"tolerance": bad}, deep=True),
        lambda: simulate(Scene.model_construct(**{**CONTENT, "tolerance": bad})),
    )
    for way in ways:
        with pytest.raises(SceneError, match="tolerance: Input should be") as caught:
            way()
        assert caught.value.key == "tolerance"


def test_a_copy_with_other_values_is_checked_in_every_part() -> None:
    with pytest.raises(SceneError, match="tolerence: there is no such key; allowed: title, effects"):
        BOUNCE.model_copy(update={"tolerence": 1e-9})
    with pytest.raises(SceneError, match=r"samples: .*greater than or equal to 1, not 0"):
        BOUNCE.time.model_copy(update={"samples": 0})
    with pytest.raises(SceneError, match=r"step: there is no such key; allowed: start, stop, samples"):
        BOUNCE.time.model_copy(update={"step": 0.1})
    with pytest.raises(SceneError, match=r"constant: .*finite"):
        BOUNCE.inputs["rack"].model_copy(update={"constant": float("nan")})
    shorter = BOUNCE.model_copy(update={"time": BOUNCE.time.model_copy(update={"samples": 3})})
    assert (len(shorter.instants), shorter.title, shorter.inputs) == (3, BOUNCE.title, BOUNCE.inputs)
    assert BOUNCE.model_copy() == BOUNCE


def test_a_tolerance_that_the_method_cannot_hold_is_noted_with_the_one_that_it_held() -> None:
    unit = float(scene_mechanism(BOUNCE).unit)
    finest, coarsest = (limit * unit / TRUNCATION_SHARE for limit in (FINEST, COARSEST))
    for tolerance, words in (
        (finest * 1.01, None),
        (finest * 0.99, f"finer than the rounding of a sum of series: {finest:.3g} mm was used"),
        (coarsest * 0.99, None),
        (coarsest * 1.01, f"is too coarse to keep to one branch: {coarsest:.3g} mm was used"),
    ):
        motion = simulate(BOUNCE.model_copy(update={"tolerance": tolerance}))
        notes = [note for note in motion.notes if note != motion.closing.words]
        assert len(notes) == (words is not None)
        assert words is None or words in notes[0]
    # Newton's method is no finer than it is asked to be, but each pose keeps to its branch by a proof.
    motion = simulate(BOUNCE.model_copy(update={"tolerance": 50.0}), "newton")
    assert motion.notes == (motion.closing.words,)


@pytest.mark.parametrize("kind", [np.uint8, np.float32, np.longdouble])
def test_a_number_of_numpy_is_a_number(kind: Callable[[int], Any]) -> None:
    points = {name: tuple(place) for name, place in BOUNCE.mechanism.points.items()}
    content = {
        **CONTENT,
        "tolerance": kind(1),
        "mechanism": {
            "type": "macpherson",
            "points": {**points, "strut_top": [kind(46), -180.0, 470.0]},
            "up": [kind(0), kind(0), kind(1)],
        },
        "inputs": {"arm_angle": {"polynomial": [kind(1), kind(2)]}, "rack": {"constant": kind(3)}},
        "time": {"start": kind(0), "stop": kind(2), "samples": np.int64(5)},
    }
    scene = Scene.from_mapping(content)
    assert scene.mechanism.points["strut_top"] == (46.0, -180.0, 470.0)
    assert scene.inputs["arm_angle"].polynomial == (1.0, 2.0)
    assert (scene.inputs["rack"].constant, scene.tolerance) == (3.0, 1.0)
    assert scene.instants.tolist() == [0.0, 0.5, 1.0, 1.5, 2.0]
    # Python's own numbers are what is kept, so that a scene is written and compared as any other.
    assert type(scene.tolerance) is type(scene.inputs["rack"].constant) is float
    assert type(scene.time.samples) is int


@plain
@given(
    start=st.decimals(-1000, 1000, places=3),
    length=st.decimals("0.001", 1000, places=3),
    steps=st.integers(1, 2000),
)
def test_instants_are_the_decimal_numbers_that_a_person_would_write(
    start: Decimal, length: Decimal, steps: int
) -> None:
    stop = start + length
    instants = even_instants(float(start), float(stop), steps + 1).tolist()
    assert len(instants) == steps + 1
    for i, instant in enumerate(instants):
        exact = Fraction(start) + Fraction(length) * i / steps
        assert instant == exact.numerator / exact.denominator  # rounded once
    assert (instants[0], instants[-1]) == (float(start), float(stop))


@pytest.mark.parametrize("source", ["file", "stream"])
def test_a_byte_order_mark_is_no_part_of_a_scene(tmp_path: Path, source: str) -> None:
    text = b"\xef\xbb\xbf" + scene_text("bounce").encode()
    path = tmp_path / "scene.toml"
    path.write_bytes(text)
    assert (Scene.load(path) if source == "file" else Scene.read(io.BytesIO(text))) == BOUNCE


class Endless(io.RawIOBase):
    """A stream without end, which counts what it gives."""

    given = 0

    def readable(self) -> bool:
        return True

    def read(self, size: int = -1) -> bytes:
        assert size >= 0
        size = min(size, 10_000_000)
        self.given += size
        return b"#" * size


def test_reading_stops_at_64_megabytes() -> None:
    endless = Endless()
    with pytest.raises(SceneError, match="standard input: has no end within 64 MB; allowed: at most 64 MB"):
        Scene.read(endless)
    assert endless.given == LARGEST + 1
    assert len(read_stream(io.BytesIO(b"#" * LARGEST), "")) == LARGEST


def test_devices_pipes_and_sockets_are_refused_and_never_waited_for(tmp_path: Path) -> None:
    pipe, door = tmp_path / "pipe", tmp_path / "door"
    os.mkfifo(pipe)
    with socket.socket(socket.AF_UNIX) as listener:
        listener.bind(str(door))
        for path in (pipe, door, Path("/dev/zero"), Path("/dev/null")):
            with pytest.raises(SceneError, match="is a device, a pipe or a socket; allowed: a regular file"):
                Scene.load(path)


def part_with(part: str, name: str, value: object) -> Scene:
    return Scene.from_mapping({**CONTENT, part: {**CONTENT[part], name: value}})


POINTS = {**CONTENT["mechanism"]["points"], STEERING: (1.0, 2.0, 3.0)}
MISNAMED: dict[str, Callable[[], object]] = {
    "file": lambda: Scene.load(STEERING),
    "key": lambda: Scene.from_mapping({**CONTENT, STEERING: 1}),
    "key of time": lambda: part_with("time", STEERING, 1),
    "point": lambda: part_with("mechanism", "points", POINTS),
    "input": lambda: part_with("inputs", STEERING, {"constant": 1}),
    "effect": lambda: Scene.from_mapping({**CONTENT, "effects": [STEERING]}),
    "value": lambda: Scene.from_mapping({**CONTENT, "tolerance": STEERING}),
    "source": lambda: Scene.from_mapping({**CONTENT, "tolerance": 0}, STEERING),
    "asked for": lambda: simulate(BOUNCE).position[STEERING],
}


@pytest.mark.parametrize("place", MISNAMED)
def test_what_would_steer_a_terminal_is_shown_as_text_in_a_few_lines(place: str) -> None:
    with pytest.raises(PointcoordError) as caught:
        MISNAMED[place]()
    message = str(caught.value)
    assert message.isprintable()
    assert r"\x1b[31m" in message
    assert len(message) < 600


@given(text=st.text(st.characters(), max_size=40))
def test_visible_text_prints_and_keeps_what_prints(text: str) -> None:
    shown = visible(text)
    assert shown.isprintable()
    assert visible(shown) == shown
    assert visible(visible(10 * text)) == visible(10 * text)
    if text.isprintable():
        assert shown == text


def test_a_scene_that_nobody_wrote_into_is_not_checked_again_and_one_that_was_is() -> None:
    scene = Scene.from_mapping(CONTENT)
    assert scene.unchanged
    assert Scene.checked(scene, "same") is scene
    scene.inputs["heave"] = scene.inputs["rack"]
    assert not scene.unchanged
    again = Scene.checked(scene, "written")
    assert again is not scene
    assert again.unchanged
    assert again.model_dump() == scene.model_dump()
    scene.mechanism.points["strut_top"] = (460.0, -180.0, float("inf"))
    with pytest.raises(SceneError, match=r"mechanism\.points\.strut_top\.2: .*finite number, not inf"):
        Scene.checked(scene, "written")


def test_a_scene_does_not_change_but_comes_back_from_a_copy_a_pickle_and_its_plain_data() -> None:
    with pytest.raises(ValidationError, match="frozen"):
        BOUNCE.time.samples = 3  # as one line by itself it does not pass a checker of types
    for again in (
        copy.deepcopy(BOUNCE),
        pickle.loads(pickle.dumps(BOUNCE)),
        Scene.from_mapping(BOUNCE.model_dump()),
        Scene.from_mapping(json.loads(BOUNCE.model_dump_json())),
    ):
        assert again == BOUNCE
        assert again.unchanged
    assert BOUNCE.model_copy(deep=True).mechanism.points is not BOUNCE.mechanism.points
    assert hash(BOUNCE.time) == hash(BOUNCE.time.model_copy())


def test_a_scene_is_simulated_by_its_name_or_path_too(tmp_path: Path) -> None:
    path = tmp_path / "car.toml"
    path.write_text(scene_text("steer"))
    motions = [simulate(given) for given in (Scene.load("steer"), "steer", path, str(path))]
    for motion in motions[1:]:
        assert np.array_equal(motion.position["wheel_centre"], motions[0].position["wheel_centre"])
    with pytest.raises(SceneError, match="did you mean 'steer'"):
        simulate("ster")
