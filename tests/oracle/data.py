"""Files of results held to a car: the verdict of every column."""

from __future__ import annotations

from pathlib import Path

from program import validated
from record import Facts, Record

GIVEN = Path(__file__).parent / "given"
RESULTS, SCENES = GIVEN / "results", GIVEN / "scenes"
BUMP, STEERING = ("lotus-bump.csv", "lotus-bump.toml"), ("lotus-steering.csv", "lotus-steering.toml")

# The file, its map, the car, and more options.
CASES: dict[str, tuple[str, str, str, tuple[str, ...]]] = {
    "the printed bump table of Lotus": (*BUMP, "double-wishbone", ()),
    "the same without its map": (BUMP[0], "", "double-wishbone", ()),
    "the same of a car with a misread hardpoint": (*BUMP, "misread-wishbone", ()),
    "the same of another car": (*BUMP, "off-axis-strut", ()),
    "the printed steering table of Lotus": (*STEERING, "double-wishbone", ()),
    "the paper's tables": ("tables-2-and-3.csv", "", "bounce", ()),
    "the paper's tables, 40 mm allowed": ("tables-2-and-3.csv", "", "bounce", ("--accuracy", "40")),
    **{
        name.replace("-", " "): (f"{name}.csv", "", "double-wishbone", ())
        for name in (
            "three-digits",
            "toe-sign",
            "camber-offset",
            "one-number-off",
            "axes-exchanged",
            "metres-as-mm",
            "by-inputs",
            "by-inputs-rack-sign",
            "words",
            "no-unit",
            "unknown-column",
            "no-such-file",
        )
    },
}


def record(folder: Path) -> Record:
    """By file: exit status, the verdict of each column and the kinds of explanations."""
    facts: Facts = {}
    for number, (case, (data, columns, scene, options)) in enumerate(CASES.items()):
        of_map = ("--map", RESULTS / columns) if columns else ()
        words = ("--data", RESULTS / data, *of_map, *options, SCENES / f"{scene}.toml")
        facts[case] = validated(folder / f"{number}.json", *words)
    return Record(facts)
