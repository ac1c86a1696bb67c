"""Mechanisms at random: bodies on joints of every kind, rods that leave few freedoms, inputs of all kinds."""

from __future__ import annotations

from dataclasses import dataclass, field
from itertools import count
from typing import Any

import numpy as np

from pointcoord.numerics.arrays import Array

CHASSIS = "chassis"
LINES = {"up": (0.0, 0.0, 1.0), "left": (0.0, -1.0, 0.0), "forward": (1.0, 0.0, 0.0)}
# By kind of joint, how many freedoms it leaves a body.
JOINTS = {"none": 6, "point on a line": 4, "ball": 3, "sliding and turning": 2, "hinge": 1, "sliding": 1}
# Of the size, how far the points of a slide are drawn off its line: by a rounding, or so that they show.
OFF = (0.0, 0.0, 1e-3)
CAR = {"axle": "front", "brake_share": 0.6, "drive_share": 0.4}
LOAD = {"force": [100.0, 900.0, 3000.0], "moment": [1e4, -2e4, 3e3]}


def random_mechanism(number: int) -> dict[str, Any]:
    """The content of a scene of one to five bodies in a short motion from the drawing, by its number.

    It may be none: inputs that fight, or a drawing whose points are not held.
    """
    return _Maker(np.random.default_rng(number)).scene()


@dataclass
class _Maker:
    random: np.random.Generator
    points: dict[str, Array] = field(default_factory=dict)
    bodies: dict[str, list[str]] = field(default_factory=lambda: {CHASSIS: []})
    rods: dict[str, list[str]] = field(default_factory=dict)
    slides: dict[str, dict[str, Any]] = field(default_factory=dict)
    hinges: list[tuple[str, str]] = field(default_factory=list)

    def scene(self) -> dict[str, Any]:
        random = self.random
        self.size = 10.0 ** random.uniform(1.0, 3.3)
        self.origin = random.normal(size=3) * self.size * random.choice([0.0, 0.0, 1.0, 30.0])
        self.numbers = count()
        moving = [f"body{i}" for i in range(random.integers(1, 6))]
        freedoms = sum(self._joined(body) for body in moving)
        freedoms -= self._held_by_rods(moving, freedoms - int(random.integers(1, 4)))
        last = self.bodies[moving[-1]]
        roles = {"knuckle": moving[-1], "steering_axis": last[:2], "wheel_axis": [self._new(), self._new()]}
        last += roles["wheel_axis"]
        inputs, laws = self._driven(freedoms)
        return {
            "mechanism": {
                "points": {name: place.tolist() for name, place in self.points.items()},
                **{"bodies": self.bodies, "rods": self.rods, "slides": self.slides},
                **{"inputs": inputs, "roles": roles, "loads": {"": LOAD}},
                **{"up": [0, 0, 1], "right": [0, 1, 0], "side": "right", "wheel_radius": 0.6 * self.size},
                "car": {**CAR, "wheelbase": 2.5 * self.size, "centre_of_gravity_height": self.size},
            },
            "inputs": laws,
            "effects": ["loads"],
            "time": {"start": 0.0, "stop": 1.0, "samples": 2},
        }

    def _new(self, place: Array | None = None) -> str:
        """A point, somewhere unless given."""
        name = f"p{next(self.numbers)}"
        somewhere = self.origin + 0.5 * self.size * self.random.normal(size=3)
        self.points[name] = somewhere if place is None else place
        return name

    def _off(self) -> Array:
        return np.asarray(self.random.normal(size=3) * self.size * self.random.choice(OFF))

    def _joined(self, body: str) -> int:
        """A body on one that is there; how many freedoms it has."""
        random, to = self.random, str(self.random.choice([*self.bodies]))
        kind, own = str(random.choice([*JOINTS])), self.bodies.setdefault(body, [])
        shared = [self._new() for _ in range({"ball": 1, "hinge": 2}.get(kind, 0))]
        own += shared
        self.bodies[to] += shared
        if kind == "hinge":
            self.hinges.append((body, to))
        if kind == "point on a line":
            through, along = self._new(), str(random.choice([*LINES]))
            away = self.size * random.uniform(0.2, 1.0) * np.array(LINES[along])
            own.append(self._new(self.points[through] + away + self._off()))
            self.slides[f"slide{body}"] = {"point": own[0], "body": to, "through": through, "along": along}
            self.bodies[to].append(through)
        if kind.startswith("sliding"):
            through, rear = self._new(), self._new()
            share = random.uniform(0.3, 0.8)
            front = share * self.points[rear] + (1.0 - share) * self.points[through] + self._off()
            own += [self._new(front), rear]
            ends = {"points": own[:2], "body": to, "through": through, "along": rear}
            self.slides[f"slide{body}"] = {**ends, "turns": kind != "sliding"}
            self.bodies[to].append(through)
        own += [self._new() for _ in range(int(random.integers(max(3 - len(own), 0), 4)))]
        return JOINTS[kind]

    def _held_by_rods(self, moving: list[str], most: int) -> int:
        """Rods from moving bodies to others; how many."""
        while len(self.rods) < most:
            one = str(self.random.choice(moving))
            other = str(self.random.choice([body for body in self.bodies if body != one]))
            ends = []
            for body in (one, other):
                if not self.bodies[body] or self.random.random() < 0.5:
                    self.bodies[body].append(self._new())
                    ends.append(self.bodies[body][-1])
                else:
                    ends.append(str(self.random.choice(self.bodies[body])))
            if ends[0] not in self.bodies[other] and ends[1] not in self.bodies[one]:
                self.rods[f"rod{len(self.rods)}"] = ends
        return len(self.rods)

    def _driven(self, number: int) -> tuple[dict[str, Any], dict[str, Any]]:
        """As many inputs, and how each goes from its drawn value by a small part of the size."""
        fixed = {*self.bodies[CHASSIS]}
        moving = [
            p for body, names in self.bodies.items() if body != CHASSIS for p in names if p not in fixed
        ]
        found: list[tuple[dict[str, Any], float, bool]] = []
        for name, slide in self.slides.items():
            point = slide["point"] if "point" in slide else slide["points"][0]
            found.append(({"travel": name}, self._apart(point, slide["through"]), False))
        found += [
            ({"angle": body, "from": "drawing"} | ({} if on == CHASSIS else {"on": on}), 0.0, True)
            for body, on in self.hinges
        ]
        found += [
            ({"height": str(self.random.choice(moving)), "along": along}, 0.0, False) for along in LINES
        ]
        first, second = str(self.random.choice(moving)), str(self.random.choice([*self.points]))
        if first != second:
            found.append(({"distance": [first, second]}, self._apart(first, second), False))
        for body, on in self.hinges:
            of, about = self.bodies[body][2], self.bodies[body][0]
            if on == CHASSIS:
                up = self.points[of] - self.points[about]
                turn = float(np.arccos(up[2] / np.linalg.norm(up)))
                found.append(({"angle": body, "of": of, "about": about, "from": "up"}, turn, True))
        inner, centre = self.bodies[[*self.bodies][-1]][-2:]
        over = {"over": "ground"} if self.bodies[CHASSIS] and self.random.random() < 0.5 else {}
        found.append(({"contact": [inner, centre], **over}, 0.0, False))
        chosen = [found[i] for i in self.random.permutation(len(found))[:number]]
        if self.bodies[CHASSIS] and self.random.random() < 0.3:
            about = str(self.random.choice(self.bodies[CHASSIS]))
            chosen.append(({"turns": CHASSIS, "about": about, "along": "forward"}, 0.0, True))
        if self.random.random() < 0.3:
            chosen.append(({"moves": CHASSIS, "along": "up"}, 0.0, False))
        inputs, laws = {}, {}
        for i, (one, start, is_angle) in enumerate(chosen):
            by = self.random.uniform(0.003, 0.03) * (3.0 if is_angle else self.size)
            inputs[f"input{i}"], laws[f"input{i}"] = one, {"polynomial": [start, by, -0.4 * by]}
        return inputs, laws

    def _apart(self, one: str, other: str) -> float:
        return float(np.linalg.norm(self.points[one] - self.points[other]))
