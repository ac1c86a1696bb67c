"""The kinds of faults that are looked for, as data; a new kind is a function and a line here."""

from __future__ import annotations

from validate.diagnosis.hypothesis import Kind
from validate.diagnosis.kinds.amounts import factors, offsets, printed_digits
from validate.diagnosis.kinds.hardpoint import misread_hardpoints, points_that_rest_elsewhere
from validate.diagnosis.kinds.links import other_assemblies, other_closures, other_lines, wrong_lengths
from validate.diagnosis.kinds.motions import shifted_in_time, wrong_inputs
from validate.diagnosis.kinds.numbers import (
    exchanged_axes,
    mirrored,
    of_another_instant,
    other_definitions,
    other_signs,
    other_units,
    sides_exchanged,
    swapped,
)
from validate.diagnosis.kinds.rates import differences, per_input

KINDS = (
    Kind("sign", other_signs, opens=True, closes=True),
    Kind("axes", exchanged_axes, opens=True),
    Kind("mirror", mirrored),
    Kind("unit", other_units, opens=True, closes=True, hides=True),
    Kind("offset", offsets, closes=True),
    Kind("hardpoint", points_that_rest_elsewhere),
    Kind("definition", other_definitions, opens=True, hides=True),
    Kind("digits", printed_digits, closes=True),
    Kind("swapped", swapped),
    Kind("sides", sides_exchanged),
    Kind("differences", differences, of_time=True),
    Kind("rates", per_input, of_time=True),
    Kind("sample", of_another_instant, opens=True),
    Kind("closure", other_closures, "motion"),
    Kind("input", wrong_inputs, "motion", of_time=True),
    Kind("branch", other_assemblies, "motion"),
    Kind("time shift", shifted_in_time, "motion", of_time=True),
    Kind("line", other_lines, "drawing"),
    Kind("link", wrong_lengths, "drawing"),
    Kind("hardpoint", misread_hardpoints, "drawing"),
    Kind("factor", factors, "last"),
)
