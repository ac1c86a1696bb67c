"""The kinds of faults that are looked for, as data; a new kind is a function and a line here."""

from __future__ import annotations

from validate.diagnosis.hypothesis import Kind
from validate.diagnosis.kinds.amounts import factors, offsets, printed_digits
from validate.diagnosis.kinds.car_data import other_data
from validate.diagnosis.kinds.hardpoint import misread_hardpoints, points_that_rest_elsewhere
from validate.diagnosis.kinds.links import other_assemblies, other_closures, other_lines, wrong_lengths
from validate.diagnosis.kinds.motions import shifted_in_time, wrong_inputs
from validate.diagnosis.kinds.numbers import (
    exchanged_axes,
    mirrored,
    other_definitions,
    other_signs,
    other_units,
)
from validate.diagnosis.kinds.places import anothers, of_another_instant, sides_exchanged, swapped
from validate.diagnosis.kinds.rates import differences

UNIT, LINK, HARDPOINT = "unit", "link", "hardpoint"
KINDS = (
    Kind("sign", other_signs, opens=True, closes=True),
    Kind("axes", exchanged_axes, opens=True),
    Kind("mirror", mirrored),
    Kind(UNIT, other_units, opens=True, closes=True, hides=True),
    Kind("offset", offsets, closes=True),
    Kind(HARDPOINT, points_that_rest_elsewhere),
    Kind("definition", other_definitions, opens=True, hides=True),
    Kind("digits", printed_digits, closes=True),
    Kind("swapped", swapped),
    Kind("sides", sides_exchanged),
    Kind("name", anothers),
    Kind("car data", other_data),
    Kind("differences", differences, of_time=True),
    Kind("sample", of_another_instant, opens=True, neighbours=True),
    Kind("closure", other_closures, "car"),
    Kind("input", wrong_inputs, "car", of_time=True),
    Kind("branch", other_assemblies, "car"),
    Kind("time shift", shifted_in_time, "car", of_time=True),
    Kind("line", other_lines, "car"),
    Kind(LINK, wrong_lengths, "car"),
    # A rod of another length may be one whose end was misread, and the other way round.
    Kind(HARDPOINT, misread_hardpoints, "car", beside=LINK),
    Kind("factor", factors, "last"),
)
