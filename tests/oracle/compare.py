"""Holds what this checkout answers to what was frozen; see README.md beside this file.

    python tests/oracle/compare.py [PART ...] [--all] [--freeze] [--factor F]

Exit status: 0 if all is equal, 1 if something differs, 2 if the command line is wrong or a part was never
frozen.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import data
import diagnosis
import fits
import hard
import imports
import random_cars
import report
import scenes
import speed
from difference import Comparison, compared
from record import Record, read_record, write_record

FROZEN = Path(__file__).parent / "frozen"
PARTS: dict[str, Callable[[Path], Record]] = {
    "scenes": scenes.record,
    "import": imports.record,
    "fit": fits.record,
    "data": data.record,
    "diagnosis": diagnosis.record,
    "report": report.record,
    "hard": hard.record,
}
"""Parts that are facts and numbers of one run."""
QUICK = ("scenes", "import", "fit", "data", "report")
SCENES_QUICK, RANDOM, SPEED = "scenes-quick", "random", "speed"
NAMES = (SCENES_QUICK, *PARTS, RANDOM, SPEED)


def options_of(arguments: list[str]) -> argparse.Namespace:
    """What is asked for."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter, allow_abbrev=False
    )
    names = f"{', '.join(NAMES)}; if none, {', '.join(QUICK)}"
    parser.add_argument("parts", nargs="*", metavar="PART", help=names)
    parser.add_argument("--all", action="store_true", help="all parts; speed comes last")
    parser.add_argument("--freeze", action="store_true", help="keep what is answered now instead")
    parser.add_argument("--count", type=int, help="random cars: the first so many")
    parser.add_argument("--factor", type=float, help="speed: the ratio now / before that is a failure")
    options = parser.parse_args(arguments)
    unknown = [part for part in options.parts if part not in NAMES]
    if unknown:
        parser.error(f"no part is called {unknown[0]}; there are: {', '.join(NAMES)}")
    pieces = {SCENES_QUICK, SPEED}.intersection(options.parts)
    if options.freeze and (pieces or not (options.parts or options.all)):
        parser.error(
            "--freeze needs the parts to freeze; scenes-quick is a piece of scenes, speed is measured"
        )
    if options.all:
        options.parts = [*PARTS, RANDOM] if options.freeze else [*PARTS, RANDOM, SPEED]
    options.parts = options.parts or list(QUICK)
    return options


def answered(part: str, options: argparse.Namespace, folder: Path) -> Record:
    """What this checkout answers."""
    if part == SCENES_QUICK:
        return scenes.quick(folder)
    if part != RANDOM:
        return PARTS[part](folder)
    return random_cars.record(folder, random_cars.stored(FROZEN, options.count))


def was_frozen(part: str, options: argparse.Namespace) -> Record:
    """What was frozen of a part; of a piece of it, the same piece."""
    if part == SCENES_QUICK:
        return scenes.quick_of(read_record(FROZEN, "scenes"))
    whole = read_record(FROZEN, part)
    if part == RANDOM and options.count is not None:
        return whole.only(set(random_cars.stored(FROZEN, options.count)))
    return whole


def hold(part: str, options: argparse.Namespace, folder: Path) -> Comparison:
    """Freeze a part, or compare it.

    Raises:
        FileNotFoundError: it was never frozen.
    """
    if options.freeze:
        now = answered(part, options, folder)
        write_record(FROZEN, part, now)
        return compared(part, now, now)
    frozen = was_frozen(part, options)
    found = compared(part, frozen, answered(part, options, folder))
    return random_cars.unexpected(found) if part == RANDOM else found


def run_speed(options: argparse.Namespace, folder: Path) -> bool:
    """Report the speed table: whether a ratio is above the factor that is asked for.

    Raises:
        FileNotFoundError: the commit that it is compared with is not there.
    """
    lines, most = speed.told(*speed.by_turns(folder))
    print(*lines, sep="\n", flush=True)
    return options.factor is not None and most > options.factor


def main(arguments: list[str]) -> int:
    """Hold every part, a line for each difference and a last one with the counts."""
    options = options_of(arguments)
    held: list[Comparison] = []
    slow = False
    for part in options.parts:
        begun = time.monotonic()
        with tempfile.TemporaryDirectory() as folder:
            try:
                if part == SPEED:
                    slow = run_speed(options, Path(folder))
                    continue
                held.append(hold(part, options, Path(folder)))
            except FileNotFoundError as error:
                told = error.strerror if part == SPEED else "was never frozen; try --freeze"
                print(f"{part}: {error.filename}: {told}", file=sys.stderr)
                return 2
        for difference in held[-1].differences:
            print(difference)
        frozen = "frozen, " if options.freeze else ""
        print(f"{part}: {frozen}{held[-1]}, {time.monotonic() - begun:.0f} s", flush=True)
    found = [difference for one in held for difference in one.differences]
    print(f"{Comparison(found, sum(one.count for one in held))} of {', '.join(options.parts)}")
    return 1 if found or slow else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
