"""The kinds of faults that are tried; to add one, write a function and add a line here."""

from __future__ import annotations

from validate.diagnosis.hypothesis import Kind
from validate.diagnosis.kinds.hardpoint import misread_hardpoints, points_that_rest_elsewhere
from validate.diagnosis.kinds.linear import exchanged_axes, factors, mirrored, other_signs, other_units
from validate.diagnosis.kinds.links import other_assemblies, other_closures, other_lines, wrong_lengths
from validate.diagnosis.kinds.motions import shifted_in_time, wrong_inputs
from validate.diagnosis.kinds.numbers import (
    of_another_instant,
    offsets,
    other_definitions,
    printed_digits,
    sides_exchanged,
    swapped,
)
from validate.diagnosis.kinds.rates import differences, per_input

KINDS = (
    Kind("sample", of_another_instant, opens=True),
    Kind("definition", other_definitions, opens=True),
    Kind("axes", exchanged_axes, opens=True),
    Kind("sign", other_signs, opens=True, closes=True),
    Kind("unit", other_units, opens=True, closes=True),
    Kind("offset", offsets, closes=True),
    Kind("digits", printed_digits, closes=True),
    Kind("mirror", mirrored),
    Kind("hardpoint", points_that_rest_elsewhere),
    Kind("swapped", swapped),
    Kind("sides", sides_exchanged),
    Kind("differences", differences),
    Kind("rates", per_input),
    Kind("closure", other_closures, "motion"),
    Kind("input", wrong_inputs, "motion"),
    Kind("branch", other_assemblies, "motion"),
    Kind("time shift", shifted_in_time, "motion"),
    Kind("line", other_lines, "drawing"),
    Kind("link", wrong_lengths, "drawing"),
    Kind("hardpoint", misread_hardpoints, "drawing"),
    Kind("factor", factors, "last"),
)
"""All kinds. In a pair of faults in the same numbers, the first fault is earlier in this list."""
