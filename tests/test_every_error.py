"""Every error class can be met, says what is wrong, where and what to try, and carries the data it speaks of.

Whoever adds an error shows how to meet it: in a test that is beside what raises it, or here.
"""

import importlib
import inspect
import pickle
import pkgutil
import re
import sys
from collections.abc import Callable, Mapping
from math import comb
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from changed_scenes import content_of
from mechanism_drawings import CARS

import absolute.backend
import pointcoord
import validate
import validate.reference.route
from pointcoord.effects.knuckle_rates import KNUCKLE_RATES
from pointcoord.linkage.hardpoints import build_mechanism
from pointcoord.mechanism import mechanism_file
from validate.reference import NoReferenceError

PACKAGES = ("pointcoord", "absolute", "validate")
# Families, which are caught and never raised themselves.
BASES = {"PointcoordError", "AbsoluteError"}
# SIGTERM ends the program as Ctrl-C does, which `tests/validate/commands/test_door.py` tries, and so does
# what the program answers without working: its version. A solver's own failure is a formulation's refusal;
# a scene that cannot be solved ends a command (`tests/validate/commands/answered.txt`).
CAUGHT = {"Terminated", "Answer", "SolverFailed", "NotSolved"}

BOUNCE = pointcoord.Scene.load("bounce")
TABLE = dict(BOUNCE.mechanism.points)
COLLINEAR = mechanism_file("macpherson").topology(TABLE, "collinear")
UPRIGHT = {"up": (0.0, 0.0, 1.0), "right": (0.0, 1.0, 0.0)}
IN_LINE = {name: np.array([1.0, 2.0, 3.0]) * i for i, name in enumerate("abc")}


def changed(**sections: Mapping[str, Any]) -> pointcoord.Scene:
    """The built-in bounce with other inputs and times."""
    content = content_of("bounce")
    for section, changes in sections.items():
        content[section].update(changes)
    return pointcoord.Scene.from_mapping(content, "mine")


def jumping() -> pointcoord.Scene:
    """The arm jumps by 0.01 rad within a nanosecond: cubics of size 1e25 that rounding cannot hold."""
    times = (0.0, 0.2, 0.5, 0.5 + 1e-9, 0.8, 1.0)
    arm = {"table": {"times": times, "values": [1.6, 1.6, 1.6, 1.61, 1.61, 1.61]}}
    return changed(inputs={"arm_angle": arm}, time={"start": 0.5 - 2e-8, "stop": 0.5 + 2e-9})


def cancelling(power_of_two: int) -> pointcoord.Scene:
    """The rack goes 16 (t - start)^6 mm, multiplied out: terms of up to 20 start^6 each cancel to that."""
    start = 2.0**power_of_two
    terms = [16.0 * comb(6, k) * (-start) ** (6 - k) for k in range(7)]
    laws = {"rack": {"polynomial": terms}, "arm_angle": {"constant": 1.6}}
    return changed(inputs=laws, time={"start": start, "stop": start + 1.0, "samples": 5})


# How each error of pointcoord can be met, and what it says: what is wrong, where, the value, what is allowed,
# and what to try.
MET: dict[str, tuple[Callable[[], object], tuple[str, ...]]] = {
    "SceneError": (lambda: changed(time={"stop": -1.0}), ("mine: time:", "-1.0", "allowed: start < stop")),
    "UnknownName": (
        lambda: pointcoord.simulate(BOUNCE).position["wheel_center"],
        ("wheel_center", "did you mean 'wheel_centre'?", "lower_arm_front"),
    ),
    "NotComputed": (
        lambda: pointcoord.simulate(BOUNCE.model_copy(update={"effects": ()})).wheel["camber"],
        ("camber was not computed", "add 'camber'"),
    ),
    "MissingLibrary": (
        lambda: pointcoord.simulate(BOUNCE).to_dataframe(),
        (
            "needs the package 'pandas' or 'polars', which is not installed",
            "pip install 'pointcoord[pandas]'",
        ),
    ),
    "MechanismError": (
        lambda: build_mechanism(COLLINEAR, {**TABLE, "strut_lower": TABLE["lower_ball_joint"]}, UPRIGHT),
        ("link", "lower_ball_joint", "strut_lower", "no length", "move one"),
    ),
    "InputOutOfRange": (
        lambda: pointcoord.simulate(changed(inputs={"arm_angle": {"constant": 3.5}})),
        ("input 'arm_angle' is 3.5 at t = 0 s", "allowed: 0 to pi rad"),
    ),
    "InputNotKnown": (
        lambda: pointcoord.simulate(cancelling(15)),
        ("input 'rack' is not known at t = 32768 s", "cancel to 0", "off by 3.1", "a table"),
    ),
    "AssemblyError": (
        lambda: pointcoord.simulate(
            changed(inputs={"rack": {"polynomial": (0.0, 100.0)}, "arm_angle": {"constant": 1.6}})
        ),
        ("t = ", "wanted", "rack = ", "stopped at", "condition number", "bring 'rack' back"),
    ),
    "MotionTooLong": (
        lambda: pointcoord.simulate(changed(inputs={"rack": {"polynomial": (0.0, *[1e-6] * 30)}}), "series"),
        ("from 0 to 2.6 s", "segments; allowed: 5", "slow the inputs down", "'newton'"),
    ),
    "MotionTooRough": (
        lambda: pointcoord.simulate(jumping(), "series"),
        ("input 'arm_angle' changes too fast", "after t = 0.4999999", "'newton'"),
    ),
    "MotionNotMapped": (
        lambda: pointcoord.simulate(BOUNCE, "map"),
        ("after t = 0 s", "arm_angle = 0.8", "the limit of patches", "'newton'"),
    ),
    "SingularConfiguration": (
        lambda: KNUCKLE_RATES.rates(IN_LINE, IN_LINE, IN_LINE),
        ("in one line", "turn about that line is free", "move an input or a point"),
    ),
    "OutsideMotion": (
        lambda: pointcoord.simulate(BOUNCE).at(2.7),
        ("t = 2.7 s is outside", "allowed: 0 to 2.6 s"),
    ),
    "WrongArgument": (
        lambda: pointcoord.kinematic_map(BOUNCE, {"arm_angle": (1.0, 0.9), "rack": (0.0, 1.0)}),
        ("ranges['arm_angle'] is (1.0, 0.9)", "allowed: two finite numbers", "the lower first"),
    ),
    # One box of a range that reaches beyond what the links allow, and not to be cut.
    "NotCovered": (
        lambda: pointcoord.kinematic_map(
            BOUNCE, {"arm_angle": (0.5, 2.5), "rack": (-90.0, 90.0)}, halvings=0
        ),
        ("the map does not cover arm_angle = ", "a fold", "make the map of a smaller range"),
    ),
}
# The limits at which they are met.
LIMITS: dict[str, tuple[str, int]] = {
    "MotionTooLong": ("pointcoord.solve.taylor.MOST_SEGMENTS", 5),
    "MotionNotMapped": ("pointcoord.patches.way_map.ENOUGH", 0),
}

PAGE = (Path(pointcoord.__file__).with_name("README.md")).read_text(encoding="utf-8")
# The data of each error, as the page about Python lists them.
DATA = {
    name: set(re.findall(r"`(\w+)`", data))
    for name, data in re.findall(r"^\| `(\w+)` \| .* \| (.*) \|$", PAGE.partition("## Errors")[2], flags=re.M)
}


def every_error_class() -> dict[str, type[BaseException]]:
    """All exception classes that the three packages define, by name."""
    classes: dict[str, type[BaseException]] = {}
    for package in map(importlib.import_module, PACKAGES):
        for found in pkgutil.walk_packages(package.__path__, package.__name__ + "."):
            for _, one in inspect.getmembers(importlib.import_module(found.name), inspect.isclass):
                if issubclass(one, BaseException) and one.__module__ == found.name:
                    assert classes.setdefault(one.__name__, one) is one, "two errors have one name"
    return classes


CLASSES = every_error_class()


def test_every_error_class_is_met_by_some_test() -> None:
    tests = "".join(path.read_text(encoding="utf-8") for path in Path(__file__).parent.rglob("test_*.py"))
    # One error, or several in brackets.
    met = set(re.findall(r"\w+", " ".join(re.findall(r"pytest\.raises\(\s*(\([^)]*\)|[\w.]+)", tests))))
    here = {getattr(pointcoord, name).__name__ for name in MET}
    assert CLASSES.keys() - met - here == BASES - met | CAUGHT
    ours = {name for name, kind in CLASSES.items() if kind.__module__ == "pointcoord.errors"}
    assert ours == here | {"PointcoordError"}
    assert set(DATA) == here


@pytest.mark.parametrize("name", MET)
def test_an_error_is_one_line_that_says_what_to_try_and_comes_back_from_another_process(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    kind, (meet, said) = getattr(pointcoord, name), MET[name]
    if name in LIMITS:
        monkeypatch.setattr(*LIMITS[name])
    if name == "MissingLibrary":
        monkeypatch.setitem(sys.modules, "pandas", None)
        monkeypatch.setitem(sys.modules, "polars", None)
    with pytest.raises(kind) as caught:
        meet()
    error = caught.value
    assert type(error) is kind
    assert "\n" not in str(error)
    assert [words for words in said if words not in str(error)] == []
    assert DATA[kind.__name__] == vars(error).keys() - {"allowed", "advice", "partial"}
    again = pickle.loads(pickle.dumps(error))
    assert type(again) is type(error)
    assert (str(again), again.args) == (str(error), error.args)
    # A motion is another object with the same arrays.
    assert {key: repr(value) for key, value in vars(again).items()} == (
        {key: repr(value) for key, value in vars(error).items()}
    )


def test_rows_and_what_was_not_tested_come_back_from_another_process() -> None:
    rows = validate.compare(BOUNCE, "pointcoord", "pointcoord").rows
    assert pickle.loads(pickle.dumps(rows)) == rows
    error = validate.NotTested("steer", 1.0, ["camber"], 3)
    again = pickle.loads(pickle.dumps(error))
    assert (type(again), str(again), vars(again)) == (type(error), str(error), vars(error))


def test_a_way_of_the_reference_that_takes_too_long_is_given_up(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(validate.reference.route, "MOST_STEPS", 0)
    with pytest.raises(
        NoReferenceError, match=r"is given up after.*whether there is a pose is not known"
    ) as caught:
        CARS["collinear strut"].solve({"arm_angle": (1.1, 0, 0)})
    assert caught.value.value == 0


def test_without_pinocchio_the_absolute_model_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pinocchio", None)
    with pytest.raises(
        absolute.MissingPinocchioError, match=r"Pinocchio.*pip install 'pointcoord\[validate\]'"
    ):
        importlib.reload(absolute.backend)


@pytest.mark.parametrize("name", sorted(BASES))
def test_families_hold_all_errors_of_their_package_and_are_never_raised(name: str) -> None:
    family = CLASSES[name]
    assert family.__subclasses__()
    for path in Path(inspect.getfile(family)).parent.rglob("*.py"):
        assert f"raise {family.__name__}(" not in path.read_text(encoding="utf-8"), path
