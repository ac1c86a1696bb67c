"""A row of the study of cost: one way with one setting on one scene, measured, failed or left out."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

Part = Literal["accuracy", "effects", "growth", "loading", "unrelated"]
NO_EFFECT = "no effect"
"""The setting of a row of the part effects that asks for none."""
Status = Literal["measured", "failed", "left out"]


@dataclass(frozen=True)
class Time:
    """Repeated measurements of one phase, s: their median and quartiles, and how many there are."""

    median: float
    lower: float
    upper: float
    repeats: int


@dataclass(frozen=True)
class QuantityError:
    """The error of one quantity against the reference, over all of its numbers.

    Attributes:
        largest, rms: of the components, in the quantity's unit.
        radius: the reference's own proven error, the largest.
        numbers: how many components there are.
    """

    largest: float
    rms: float
    radius: float
    numbers: int


@dataclass(frozen=True)
class Row:
    """What was measured of one way.

    Attributes:
        part: of the study.
        scene: its name. way: its name. setting, value: see `way.Setting`.
        status: whether there are numbers; `reason` says why not, in words, or why there are fewer of them
            than of others.
        configurations: how many poses one solve gives.
        dense: whether one solve serves any instant.
        errors: by quantity (see `pointcoord.effects.registry.QUANTITIES`).
        not_given: quantities that the scene asks for and the way does not give, each with the reason.
        times: by phase, for all configurations together: `set-up`, `solve`, `rates`, `output`, and `first`,
            all four phases of the first run in this process; of effects `read`, and `copy` of the same bytes.
        counts: what was done in one run.
        against: what a growth row varies: `instants`, `designs` or `unknowns`; empty elsewhere.
        size: how many of these.
        peak_bytes: memory of the process at its peak above what it held before, of a growth row.
    """

    part: Part
    scene: str
    way: str
    setting: str = ""
    value: float | None = None
    status: Status = "measured"
    reason: str = ""
    configurations: int = 0
    dense: bool = False
    errors: Mapping[str, QuantityError] = field(default_factory=dict)
    not_given: Mapping[str, str] = field(default_factory=dict)
    times: Mapping[str, Time] = field(default_factory=dict)
    counts: Mapping[str, int] = field(default_factory=dict)
    against: str = ""
    size: int | None = None
    peak_bytes: int | None = None

    def seconds(self, *phases: str) -> float | None:
        """Median time of some phases together, per configuration, s; None if one of them was not measured."""
        if self.status != "measured" or not self.configurations or any(p not in self.times for p in phases):
            return None
        return sum(self.times[phase].median for phase in phases) / self.configurations
