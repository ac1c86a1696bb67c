"""The kinds of faults that are tried; to add one, write a function and add a line here."""

from __future__ import annotations

from validate.diagnosis.fault import Kind
from validate.diagnosis.kinds import drawing, motion, numbers

KINDS = (
    Kind("sample", numbers.of_another_instant, opens=True),
    Kind("definition", numbers.other_definitions, opens=True),
    Kind("axes", numbers.exchanged_axes, opens=True),
    Kind("sign", numbers.other_signs, opens=True, closes=True),
    Kind("unit", numbers.other_units, opens=True, closes=True),
    Kind("offset", numbers.offsets, closes=True),
    Kind("digits", numbers.printed_digits, closes=True),
    Kind("mirror", numbers.mirrored),
    Kind("swapped", numbers.swapped),
    Kind("names", numbers.names_exchanged),
    Kind("differences", motion.differences),
    Kind("closure", motion.other_closures, "motion"),
    Kind("input", motion.wrong_inputs, "motion"),
    Kind("time shift", motion.shifted_in_time, "motion"),
    Kind("link", drawing.wrong_lengths, "drawing"),
    Kind("hardpoint", drawing.misread_hardpoints, "drawing"),
    Kind("branch", drawing.other_assemblies, "last"),
    Kind("factor", numbers.other_factors, "last"),
)
"""All kinds. In a pair of faults in the same numbers, the first fault is earlier in this list."""
