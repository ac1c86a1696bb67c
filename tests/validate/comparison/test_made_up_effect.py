"""An effect that nobody has heard of goes through everything once the models' registries know it.

Nothing in `validate` names an effect or a quantity: a made-up length with a quantity of its own is planted in
the registries.
"""

from collections.abc import Callable, Collection
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from program import document, short_scene

import absolute
from absolute.effects import Effect as AbsoluteEffect
from absolute.results import Motion
from pointcoord import Scene
from pointcoord.bounds.enclosed_points import EnclosedPoses, Numbers
from pointcoord.effects import registry
from pointcoord.effects.effect import Effect, Poses, Quantity
from pointcoord.linkage.topology import Topology
from validate.cli import main
from validate.comparison.compare import compare
from validate.reference.car_data import WHEEL
from validate.reference.effects import registry as reference_registry
from validate.reference.effects.car import Effect as ReferenceEffect
from validate.reference.vectors import dot

STUB = Quantity("stub", "stub length", "mm", "car")


class Stub(Effect):
    """How far the wheel centre lies outboard of the inner point of the spin axis, mm."""

    def needs(self, topology: Topology) -> Collection[str]:
        return topology.wheel_axis

    def evaluate(self, poses: Poses) -> dict[str, dict[str, np.ndarray]]:
        inner, centre = (poses.states[0][name] for name in poses.mechanism.topology.wheel_axis)
        return {STUB.name: {"stub_axle": poses.axes.component(centre - inner, "outboard")}}

    def errors(self, poses: EnclosedPoses, numbers: Numbers) -> dict[str, dict[str, np.ndarray]]:
        inner, centre = (poses.points[0][name] for name in poses.mechanism.topology.wheel_axis)
        exact = poses.axes.component(centre - inner, "outboard").scaled(float(poses.mechanism.unit))
        found = numbers[STUB.name]["stub_axle"]
        return {STUB.name: {"stub_axle": exact.errors(found)}}


OURS = Stub("stub_axle", "length of the stub axle, mm", "positive outboard", 0, (STUB,), ("stub_axle",))


def stub_axle(scale: float = 1.0) -> AbsoluteEffect:
    """The absolute model's own, right or too long."""

    def value(motion: Motion) -> np.ndarray:
        return scale * motion.components(motion.line(*motion.corner.ends("wheel_axis")))[0].value

    return AbsoluteEffect("mm", value)


# In the reference, whose derivatives make bounds of the absolute model's stated accuracy.
REFERENCE = ReferenceEffect("stub_axle", "mm", (WHEEL,), lambda car: dot(car.wheel.along, car.outboard))

Plant = Callable[..., None]


@pytest.fixture
def planted(monkeypatch: pytest.MonkeyPatch) -> Plant:
    """Registers the effect in pointcoord and the reference, and in absolute one that it is to know."""
    monkeypatch.setitem(registry.EFFECTS, OURS.name, OURS)
    monkeypatch.setitem(registry.QUANTITIES, STUB.name, STUB)
    monkeypatch.setitem(reference_registry.EFFECTS, REFERENCE.name, REFERENCE)

    def in_absolute(stub: AbsoluteEffect) -> None:
        known = {**absolute.EFFECTS, "stub_axle": stub}
        monkeypatch.setattr(absolute, "EFFECTS", known)
        monkeypatch.setattr("absolute.effects.EFFECTS", known)

    in_absolute(stub_axle())
    return in_absolute


def asked(name: str) -> Scene:
    """A built-in scene that asks for the new effect, and for one that has always been there."""
    content: dict[str, Any] = Scene.load(name).model_dump(mode="json", exclude_none=True)
    return Scene.from_mapping({**content, "effects": ["velocity", "camber", "stub_axle"]})


@pytest.mark.parametrize(
    ("scale", "verdict"), [(1.0, "agrees"), (1.0 + 1e-11, "disagrees"), (None, "not given")]
)
def test_it_is_compared_like_every_other(
    scale: float | None, verdict: str, planted: Plant, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Right, with a fault, and in a model that does not know it, of which there is no verdict."""
    if scale is None:
        known = {name: effect for name, effect in absolute.EFFECTS.items() if name != "stub_axle"}
        monkeypatch.setattr("absolute.effects.EFFECTS", known)
    else:
        planted(stub_axle(scale))
    outcome = compare(asked("off-axis-strut"), "pointcoord", "absolute")
    assert {(r.quantity, r.name): r.verdict for r in outcome.rows if r.name == "stub_axle"} == {
        ("stub", "stub_axle"): verdict
    }
    assert {row.quantity for row in outcome.rows} == {"position", "velocity", "wheel", "stub"}
    assert outcome.agreed == (verdict == "agrees")
    assert len(outcome.disagreements) == (verdict == "disagrees")
    assert {*outcome.missing} == ({"absolute gives no stub length"} if scale is None else set())


def test_every_command_has_it(planted: Plant, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = short_scene(tmp_path, effects='["stub_axle"]')
    assert main(["plan", path]) == 0
    out = capsys.readouterr().out
    assert "computed: length of the stub axle, mm (stub_axle)" in out
    assert "left out: velocity, " in out
    assert main(["simulate", path]) == 0
    head, first, *_ = capsys.readouterr().out.splitlines()
    row = dict(zip(head.split(","), map(float, first.split(",")), strict=True))
    places = {axis: row[f"position.wheel_centre.{axis} [mm]"] for axis in "xyz"}
    # A left wheel: outboard is -y.
    assert row["stub.stub_axle [mm]"] == pytest.approx(row["position.strut_lower.y [mm]"] - places["y"])
    assert main(["validate", path, "--json", "-"]) == 0
    data = document(capsys.readouterr().out)
    rows = {(r["quantity"], r["name"]): r["unit"] for r in data["scenes"][0]["comparisons"][0]["rows"]}
    assert rows["stub", "stub_axle"] == "mm"
