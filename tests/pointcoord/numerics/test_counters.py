"""Counts of work are added count by count, whatever counts there are."""

from dataclasses import astuple, fields

from pointcoord.numerics.counters import Work


def test_every_count_of_a_sum_is_the_sum_of_the_counts() -> None:
    names = [field.name for field in fields(Work)]
    one = Work(**{name: 3**i for i, name in enumerate(names)})
    other = Work(**{name: 2 * 3**i for i, name in enumerate(names)})
    assert astuple(one + other) == tuple(3 ** (i + 1) for i in range(len(names)))


def test_who_has_done_nothing_counts_nothing() -> None:
    assert not any(astuple(Work()))
