"""Some rows of a constraint, where the others follow from the rest of the mechanism."""

from __future__ import annotations

from dataclasses import dataclass

from pointcoord.linkage.constraints.constraint import Constraint
from pointcoord.linkage.drawing import Drawing, Placed
from pointcoord.linkage.layout import Layout
from pointcoord.numerics.quadratic import Row


@dataclass(frozen=True)
class SomeRows(Constraint):
    """A constraint with some of its rows, by number; all its coordinates stay."""

    whole: Constraint
    kept: tuple[int, ...]

    @property
    def name(self) -> str:
        """As of the whole."""
        return self.whole.name

    @property
    def labels(self) -> tuple[str, ...]:
        """Of the kept rows."""
        return tuple(self.whole.labels[row] for row in self.kept)

    def rows(self, layout: Layout) -> tuple[Row, ...]:
        """The kept ones."""
        rows = self.whole.rows(layout)
        return tuple(rows[row] for row in self.kept)

    @property
    def vectors(self) -> tuple[str, ...]:
        """As of the whole."""
        return self.whole.vectors

    @property
    def slides(self) -> tuple[str, ...]:
        """As of the whole."""
        return self.whole.slides

    @property
    def constants(self) -> tuple[str, ...]:
        """As of the whole."""
        return self.whole.constants

    @property
    def squared_lengths(self) -> tuple[tuple[str, str], ...]:
        """As of the whole."""
        return self.whole.squared_lengths

    @property
    def aligned(self) -> tuple[()] | tuple[str, str, str]:
        """As of the whole."""
        return self.whole.aligned

    @property
    def segments(self) -> tuple[tuple[str, str], ...]:
        """As of the whole."""
        return self.whole.segments

    @property
    def may_lock(self) -> bool:
        """As of the whole."""
        return self.whole.may_lock

    @property
    def holds_a_body(self) -> bool:
        """As of the whole."""
        return self.whole.holds_a_body

    @property
    def is_length(self) -> bool:
        """Its rows are no longer the components of a distance."""
        return False

    def placed(self, layout: Layout, drawing: Drawing) -> tuple[Placed, ...]:
        """As of the whole."""
        return self.whole.placed(layout, drawing)
