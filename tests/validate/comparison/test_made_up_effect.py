"""An effect that nobody has heard of goes through everything once the models' registries know it.

Nothing in `validate` names an effect or a quantity: a made-up length with a quantity of its own is planted in
the registries.
"""

from pathlib import Path

import numpy as np
import pytest
from changed_scenes import scene_with
from program import document, short_scene

import absolute
from absolute.effects import Effect as AbsoluteEffect
from absolute.results import Motion
from pointcoord.effects import registry
from pointcoord.effects.car_number import CarNumbers, Number
from pointcoord.effects.effect import Quantity
from validate.cli import main
from validate.comparison.compare import compare
from validate.reference.car_data import WHEEL
from validate.reference.effects import registry as reference_registry
from validate.reference.effects.car import Effect as ReferenceEffect
from validate.reference.vectors import dot

PAIR = ("pointcoord", "absolute")
STUB = Quantity("stub", "stub length", "mm", "car")


LENGTH = Number(
    name="stub_axle",
    words="stub axle",
    sign="outboard",
    formula=lambda corner: corner.seen.along(corner.seen.spin, "outboard"),
    quantity=STUB,
    needs_radius=False,
)
OURS = CarNumbers.of("stub_axle", "length of the stub axle, mm", LENGTH)
# In the reference, whose derivatives make bounds of the absolute model's stated accuracy.
REFERENCE = ReferenceEffect("stub_axle", "mm", (WHEEL,), lambda car: dot(car.wheel.along, car.outboard))


def known_to_absolute(monkeypatch: pytest.MonkeyPatch, scale: float | None) -> None:
    """The absolute model's own, right or too long; None for a model that does not know it."""

    def value(motion: Motion) -> np.ndarray:
        return scale * motion.components(motion.line(*motion.corner.need("wheel_axis")))[0].value

    own = {} if scale is None else {"stub_axle": AbsoluteEffect("mm", value)}
    monkeypatch.setattr("absolute.effects.EFFECTS", {**absolute.EFFECTS, **own})


@pytest.fixture(autouse=True)
def planted(monkeypatch: pytest.MonkeyPatch) -> None:
    """The effect in the registries of pointcoord and of the reference."""
    monkeypatch.setitem(registry.EFFECTS, OURS.name, OURS)
    monkeypatch.setitem(registry.QUANTITIES, STUB.name, STUB)
    monkeypatch.setitem(registry.NUMBERS_OF_THE_CAR, LENGTH.name, LENGTH)
    monkeypatch.setitem(reference_registry.EFFECTS, REFERENCE.name, REFERENCE)


@pytest.mark.parametrize(
    ("scale", "verdict"), [(1.0, "agrees"), (1.0 + 1e-11, "disagrees"), (None, "not given")]
)
def test_it_is_compared_like_every_other(
    scale: float | None, verdict: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Right, with a fault, and in a model that does not know it, of which there is no verdict."""
    known_to_absolute(monkeypatch, scale)
    outcome = compare(scene_with("off-axis-strut", effects=["velocity", "camber", "stub_axle"]), *PAIR)
    assert [r.verdict for r in outcome.rows if (r.quantity, r.name) == ("stub", "stub_axle")] == [verdict]
    assert {row.quantity for row in outcome.rows} == {"position", "velocity", "wheel", "stub"}
    assert outcome.agreed == (verdict == "agrees")
    assert len(outcome.disagreements) == (verdict == "disagrees")
    assert {*outcome.missing} == ({"absolute gives no stub length"} if scale is None else set())


def test_every_command_has_it(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    known_to_absolute(monkeypatch, 1.0)
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
