"""One car for each closed form that tests hold the reference to, and inputs near its drawing."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any

from lotus_front import POINTS as LOTUS
from plain_mechanisms import design_of, solve_car

from validate.cars.paper_car import PAPER
from validate.reference import Instant
from validate.reference.design import Design, Known, values_only
from validate.reference.vectors import Vector

Points = Mapping[str, Vector]
Inputs = Mapping[str, tuple[Any, ...]]

# Left wheel, in whole mm. It does not close, and the paper has no point wheel_axis_inner.
TABLE_1 = {name: tuple(map(int, place)) for name, place in PAPER.items()}
FRONT_AXLE = {
    "axle": "front",
    "wheelbase": 2600,
    "centre_of_gravity_height": 540,
    "brake_share": Fraction(5, 8),
    "drive_share": Fraction(1, 4),
    "spring_rate": Fraction(63, 2),
    "spring_free_length": 720,
}
# A strut of a real car's size, mm, which closes; the ball joint is a few centimetres beside the strut's axis.
OFF_AXIS = {
    "lower_arm_front": (1200, -350, 200),
    "lower_arm_rear": (1500, -340, 210),
    "rack_centre": (1450, -100, 250),
    "strut_top": (1330, -560, 820),
    "lower_ball_joint": (1310, -720, 190),
    "tie_rod_outer": (1440, -690, 230),
    "strut_lower": (1318, -640, 330),
    "strut_rod_end": (1324, -600, 575),
    "tie_rod_inner": (1450, -330, 250),
    "wheel_centre": (1312, -770, 300),
    "wheel_axis_inner": (1312, -660, 302),
}


@dataclass(frozen=True)
class ReferenceCar:
    """Points of a car, mm, and inputs near its drawing at which it moves in a regular way.

    Attributes:
        last_rack: rack travel beyond which there is no pose at the arm angle of `inputs`, mm.
    """

    suspension: str
    closure: str
    points: Points
    inputs: Inputs
    last_rack: Fraction
    side: str = "left"
    frame: Mapping[str, Vector] = field(default_factory=dict)
    wheel_radius: Fraction = Fraction(290)
    car: Mapping[str, object] = field(default_factory=lambda: FRONT_AXLE)

    @property
    def kind(self) -> dict[str, Any]:
        """What every function of the reference is told beside points and inputs."""
        return {
            "suspension": self.suspension,
            "closure": self.closure,
            "side": self.side,
            "wheel_radius": self.wheel_radius,
            "car": self.car,
            **self.frame,
        }

    @property
    def still(self) -> dict[str, tuple[Any, ...]]:
        """The inputs without motion."""
        return {name: (triple[0], 0, 0) for name, triple in self.inputs.items()}

    @property
    def design(self) -> Design:
        return design_of(self.points, **self.kind)

    def known(self, **changed: object) -> Known:
        """What the equations take as given, without motion; some inputs changed."""
        design = self.design
        inputs = {**self.still, **{name: (value, 0, 0) for name, value in changed.items()}}
        return values_only(design.known(design.driven(inputs)))

    def solve(self, inputs: Inputs, **settings: Any) -> Instant:
        return solve_car(self.points, inputs, **{**self.kind, **settings})


CARS = {
    "strut as drawn": ReferenceCar(
        "macpherson",
        "drawn",
        OFF_AXIS,
        {
            "arm_angle": (Fraction(3, 2), Fraction(2), Fraction(-3)),
            "rack": (Fraction(240), Fraction(150), Fraction(-400)),
            "heave": (Fraction(5), Fraction(-60), Fraction(700)),
        },
        Fraction(600),
    ),
    "collinear strut": ReferenceCar(
        "macpherson",
        "collinear",
        TABLE_1,
        {
            "arm_angle": (Fraction(3, 2), Fraction(1, 4), Fraction(1, 8)),
            "rack": (Fraction(20), Fraction(150), Fraction(50)),
            "heave": (Fraction(3), Fraction(100), Fraction(10)),
        },
        Fraction(200),
    ),
    "double wishbone": ReferenceCar(
        "double_wishbone",
        "drawn",
        LOTUS,
        {
            "arm_angle": (Fraction(3, 2), Fraction(1, 2), Fraction(-1, 4)),
            "rack": (Fraction(10), Fraction(-150), Fraction(50)),
            "heave": (Fraction(-4), Fraction(80), Fraction(20)),
        },
        Fraction(300),
        "right",
    ),
}
