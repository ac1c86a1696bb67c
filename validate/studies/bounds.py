"""Whether pointcoord's proven bounds hold, and how loose they are, up to the poses where a car locks.

Two sets of random poses (see `singular`), each reproducible by its number: cars held close to the end of
an input, and motions that run towards such an end, at random instants inside their series.

    python -m validate.studies.bounds --poses 10000
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence

from validate.cars.near_singular import near_pose
from validate.door import guarded
from validate.exit_status import ExitStatus
from validate.output.console import Console
from validate.output.document import Head, write_json
from validate.output.files import require_writable
from validate.studies.bound_checks import BoundStudy, Check, Refusal, held_pose, moving_instants
from validate.studies.bounds_report import bounds_data, bounds_text


def study(poses: int, seed: int, motions: int | None = None) -> BoundStudy:
    """Hold poses and instants of motions against the reference.

    Args:
        poses: how many cars are held close to the end of an input.
        motions: how many motions run towards one; a twentieth of the poses unless given.
    """
    results = [result for number in range(poses) for result in held_pose(near_pose(number, seed))]
    count = poses // 20 if motions is None else motions
    moved = [result for number in range(count) for result in moving_instants(number, seed)]
    return BoundStudy(
        seed=seed,
        held=tuple(r for r in results if isinstance(r, Check)),
        moving=tuple(r for r in moved if isinstance(r, Check)),
        refusals=tuple(r for r in (*results, *moved) if isinstance(r, Refusal)),
    )


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a study and print it; 0 if every bound holds, else 1."""
    parser = argparse.ArgumentParser(prog="python -m validate.studies.bounds", description=study.__doc__)
    parser.add_argument("--poses", type=int, default=10_000)
    parser.add_argument("--motions", type=int)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--json", metavar="FILE", help="- for standard output, which is then all of it")
    options = parser.parse_args(arguments)
    return guarded(lambda console: _run(options, console), "validate.studies.bounds")


def _run(options: argparse.Namespace, console: Console) -> ExitStatus:
    if options.json not in (None, "-"):
        require_writable(options.json)
    head = Head.of("bounds", ("python", "-m", "validate.studies.bounds", *sys.argv[1:]))
    done = study(options.poses, options.seed, options.motions)
    status = ExitStatus.DISAGREE if done.broken else ExitStatus.AGREE
    if options.json:
        write_json(options.json, head.document(bounds_data(done), status, True), console)
    console.mute = options.json == "-"
    console.say(bounds_text(done))
    return status


if __name__ == "__main__":
    raise SystemExit(main())
