"""Whether pointcoord's proven bounds hold, and how loose they are, up to the poses where a car locks.

Two sets of random poses (see `singular`), each reproducible by its number: cars held close to the end of
an input, and motions that run towards such an end, at random instants inside their series.

    python -m validate.bounds --poses 10000
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence

from validate.bound_checks import BoundStudy, Check, Refusal, held_pose, moving_instants
from validate.bounds_report import bounds_data, bounds_text
from validate.document import Head, write_json
from validate.door import guarded
from validate.exit_status import ExitStatus
from validate.files import require_writable
from validate.output import Console
from validate.singular import near_pose


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
    parser = argparse.ArgumentParser(prog="python -m validate.bounds", description=study.__doc__)
    parser.add_argument("--poses", type=int, default=10_000)
    parser.add_argument("--motions", type=int)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--json", metavar="FILE", help="- for standard output, which is then all of it")
    options = parser.parse_args(arguments)
    return guarded(lambda console: _run(options, console), "validate.bounds")


def _run(options: argparse.Namespace, console: Console) -> ExitStatus:
    if options.json not in (None, "-"):
        require_writable(options.json)
    head = Head.of("bounds", ("python", "-m", "validate.bounds", *sys.argv[1:]))
    done = study(options.poses, options.seed, options.motions)
    status = ExitStatus.DISAGREE if done.broken else ExitStatus.AGREE
    if options.json:
        write_json(options.json, head.document(bounds_data(done), status, True), console)
    console.mute = options.json == "-"
    console.say(bounds_text(done))
    return status


if __name__ == "__main__":
    raise SystemExit(main())
