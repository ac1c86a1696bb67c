"""Another closure: the drawing closed otherwise than the scene asks for."""

from __future__ import annotations

from collections.abc import Iterator

from pointcoord import PointcoordError
from pointcoord.method import AUTO
from pointcoord.simulation import prepare_task, solve_task
from validate.diagnosis.evidence import Evidence
from validate.diagnosis.hypothesis import Hypothesis, Kind
from validate.diagnosis.kinds.inputs import rows_of


class Closure(Kind):
    """Each other closure of the scene's type of suspension."""

    name, solves, first, of_time = "closure", True, True, True

    def hypotheses(self, evidence: Evidence) -> Iterator[Hypothesis]:
        """The whole car, closed by each of them."""
        scene = evidence.solved.fine
        part = scene.mechanism
        for closure in part.file.closures:
            if closure == part.closure:
                continue
            mechanism = part.model_copy(update={"closure": closure})
            try:
                # No drawing check: a drawing that is asked to close otherwise may not close so by itself.
                task = prepare_task(scene.model_copy(update={"mechanism": mechanism, "points": None}), AUTO)
                rows = rows_of(evidence, solve_task(task))
            except PointcoordError:
                continue
            words = f"the car is closed as {closure}, where the scene asks for {part.closure}"
            # Closed otherwise, a car may have the lengths of another assembly of it, which is less likely.
            yield Hypothesis(self.name, closure, words, rows, cost=0.9, whole=True)


KIND = Closure()
