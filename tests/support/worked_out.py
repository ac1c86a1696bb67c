"""A study worked out here, in one process and without a cluster."""

from validate.long_studies.scheduler import rows_of
from validate.long_studies.study import Row, Study


def worked_out(study: Study) -> list[Row]:
    """Its rows in the order of its numbers."""
    return list(rows_of(study, study.numbers, "here"))


def without_who_and_how_long(rows: list[Row]) -> list[Row]:
    """What of rows does not depend on who worked them out."""
    return [{**row, "worker": None, "seconds": None} for row in rows]
