"""Units of other programs are so many of ours, and text is read whatever its code."""

import numpy as np
import pytest

from validate.tables.cells import text_of
from validate.tables.units import factor_of, length_called


@pytest.mark.parametrize(
    ("theirs", "ours", "factor"),
    [
        ("m/s^2", "mm/s^2", 1000.0),
        ("m/s^3", "mm/s^3", 1000.0),
        ("in", "mm", 25.4),
        ("inch", "mm", 25.4),
        ("metres", "mm", 1000.0),
        ("deg/s", "rad/s", np.pi / 180.0),
        ("mm/ms", "mm/s", 1000.0),
        ("kN", "N", 1000.0),
        ("%", "%", 1.0),
        ("%", "rad", None),
        ("deg", "mm", None),
        ("m/s", "mm/s^2", None),
        ("m/s\N{SUPERSCRIPT THREE}", "mm/s^2", None),
        ("furlong", "mm", None),
    ],
)
def test_units_are_so_many_of_ours(theirs: str, ours: str, factor: float | None) -> None:
    assert factor_of(theirs, ours) == (factor and pytest.approx(factor, rel=1e-15))


def test_a_length_may_be_spelt() -> None:
    assert [length_called(word) for word in ("Metres", "inch", "mm", "deg")] == ["m", "in", "mm", ""]


@pytest.mark.parametrize("code", ["utf-8-sig", "utf-16", "cp1252"])
def test_text_is_read_whatever_its_code_and_bytes_are_no_text(code: str) -> None:
    assert text_of("Donn\u00e9es".encode(code)) == "Donn\u00e9es"
    assert text_of(b"PK\x03\x04\x00\x00") is None
