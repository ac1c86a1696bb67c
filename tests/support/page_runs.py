"""Runs as a page is made of them, from scenes that were examined before."""

from validate.ci.record import Record
from validate.html.run import Drawn, Run
from validate.output.document import Head


def run_of(*scenes: Drawn, factor: float = 1.0) -> Run:
    """A run of scenes, and what they come to."""
    record = Record([one.examined.name for one in scenes], factor)
    for one in scenes:
        record.add(one.examined, scene=one.scene)
    return Run(Head.of("validate", ("pointcoord", "report", "out")), record, scenes)
