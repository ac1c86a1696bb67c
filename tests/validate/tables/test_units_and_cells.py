"""Units of other programs are so many of ours, and text is read whatever its code."""

import numpy as np
import pytest

from validate.tables.cells import text_of
from validate.tables.units import factor_of, length_called


def test_units_are_what_they_are_of_ours() -> None:
    assert factor_of("m/s^2", "mm/s^2") == 1000.0
    assert factor_of("in", "mm") == 25.4
    assert factor_of("deg/s", "rad/s") == pytest.approx(np.pi / 180.0, rel=1e-15)
    assert factor_of("mm/ms", "mm/s") == pytest.approx(1000.0)
    assert factor_of("deg", "mm") is None
    assert factor_of("m/s", "mm/s^2") is None
    assert factor_of("furlong", "mm") is None
    assert factor_of("m/s^3", "mm/s^3") == 1000.0
    assert factor_of("m/s\N{SUPERSCRIPT THREE}", "mm/s^2") is None
    assert factor_of("kN", "N") == 1000.0
    assert factor_of("%", "%") == 1.0
    assert factor_of("%", "rad") is None


@pytest.mark.parametrize(("word", "unit"), [("Metres", "m"), ("inch", "in"), ("mm", "mm"), ("deg", "")])
def test_a_length_may_be_spelt(word: str, unit: str) -> None:
    assert length_called(word) == unit
    assert (factor_of(word.lower(), "mm") is not None) == bool(unit)


@pytest.mark.parametrize("code", ["utf-8-sig", "utf-16", "cp1252"])
def test_text_is_read_whatever_its_code_and_bytes_are_no_text(code: str) -> None:
    assert text_of("Donn\u00e9es".encode(code)) == "Donn\u00e9es"
    assert text_of(b"PK\x03\x04\x00\x00") is None
