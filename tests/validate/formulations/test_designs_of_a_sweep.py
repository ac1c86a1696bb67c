"""Designs of a sweep agree with a model that solves them one by one in other coordinates."""

from dataclasses import dataclass

import pytest

from pointcoord import Scene, Sweep, designs_of, sweep
from pointcoord.simulation import finest_tolerance
from validate.comparison.compare import compare
from validate.formulations.protocol import Accuracy, Solution

OFFSETS = (-4.0, 0.0, 5.0)


def cars(name: str, coordinate: str) -> tuple[Sweep, list[Scene]]:
    """A sweep as finely as series go, and its designs as scenes."""
    scene = Scene.load(name)
    time = scene.time.model_copy(update={"samples": 9})
    scene = scene.model_copy(update={"time": time, "tolerance": finest_tolerance(scene)})
    designs = designs_of(scene, offsets={coordinate: OFFSETS})
    return sweep(designs), [designs.design(number) for number in range(len(OFFSETS))]


@dataclass(frozen=True)
class FromASweep:
    """One design of a sweep as a formulation; it claims what a method may be off where nothing is wrong.

    Twice that: the design is cut by the series of its neighbours, as finely as it would be by its own.
    """

    found: Sweep
    number: int
    name: str = "sweep"

    def solve(self, scene: Scene) -> Solution:
        proof = self.found.proof(self.number, rates=True)
        claims = {
            quantity: {name: 2.0 * expected for name, expected in each.items()}
            for quantity, each in proof.expected.items()
        }
        samples = self.found.of(self.number)
        return Solution(
            self.name, samples.times, samples.numbers, Accuracy(proof.condition, claims, proven=True)
        )


@pytest.mark.parametrize(
    ("name", "coordinate"),
    [
        ("double-wishbone", "upper_ball_joint.y"),
        ("off-axis-strut", "strut_top.x"),
        ("steer", "tie_rod_outer.z"),
    ],
)
def test_designs_of_a_sweep_agree_with_the_absolute_model(name: str, coordinate: str) -> None:
    found, scenes = cars(name, coordinate)
    assert found.solved.all()
    for number, scene in enumerate(scenes):
        outcome = compare(scene, FromASweep(found, number), "absolute")
        assert outcome.agreed, outcome.disagreements


def test_another_design_does_not_agree() -> None:
    found, scenes = cars("double-wishbone", "upper_ball_joint.y")
    outcome = compare(scenes[1], FromASweep(found, 2), "absolute")
    assert {"position", "wheel", "velocity"} <= {row.quantity for row in outcome.disagreements}
