"""A row of the long table: one quantity of one way with one setting, measured, failed or left out."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, ClassVar, Literal

from pydantic import ConfigDict, Field

Size = Annotated[float, Field(ge=0.0, allow_inf_nan=False)]
Count = Annotated[int, Field(ge=0, lt=2**63)]
Part = Literal["accuracy", "effects", "growth", "loading", "unrelated"]
Verdict = Literal["measured", "failed", "left out"]


@dataclass(frozen=True)
class Row:
    """What was measured. Every number is a size or a count; None where there is none.

    Attributes:
        part: of the study. scene: its name. way: its name.
        setting: in words, such as `1e-9 mm`. value: the number in it that is dialled.
        dense: whether one solve serves any instant.
        against: what a row of growth varies: `instants`, `designs` or `unknowns`. size: how many of them.
        poses: that one run gives.
        quantity: see `pointcoord.effects.registry.QUANTITIES`; `read` and `copy` of effects.
        error, rms: against the reference, largest and root mean square of the components, in the quantity's
            unit. radius: the reference's own proven error. numbers: how many components there are.
        time: from instants to arrays, s a pose, median of the repeats; lower, upper: their quartiles.
        set_up: s a run, median: what is done before the instants are known. first: the first run, set-up
            included, s.
        peak_bytes: memory at its peak above what was held before.
        work: what one run did, such as `residuals 120, jacobians 40`.
        reason: why there are no numbers.
        digest: of the scene's content. quick: whether less was measured, as `--quick` asks.
        program, machine, python, packages, command: by what it was measured.
    """

    __pydantic_config__: ClassVar[ConfigDict] = ConfigDict(strict=True, extra="forbid")

    part: Part
    scene: str
    way: str
    setting: str = ""
    value: Size | None = None
    dense: bool = False
    against: str = ""
    size: Count | None = None
    poses: Count = 0
    quantity: str = ""
    error: Size | None = None
    rms: Size | None = None
    radius: Size | None = None
    numbers: Count | None = None
    time: Size | None = None
    lower: Size | None = None
    upper: Size | None = None
    repeats: Count | None = None
    set_up: Size | None = None
    first: Size | None = None
    peak_bytes: Count | None = None
    work: str = ""
    verdict: Verdict = "measured"
    reason: str = ""
    digest: str = ""
    quick: bool = False
    program: str = ""
    machine: str = ""
    python: str = ""
    packages: str = ""
    command: str = ""

    @property
    def key(self) -> tuple[object, ...]:
        """Of which run it is."""
        return (*self.line, self.size)

    @property
    def line(self) -> tuple[object, ...]:
        """The same whatever the size."""
        return (self.part, self.scene, self.digest, self.way, self.setting, self.against, self.quick)
