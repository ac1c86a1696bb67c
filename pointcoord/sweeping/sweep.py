"""One call solves many designs, whole or block by block."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping

from numpy.typing import ArrayLike

from pointcoord.errors import WrongArgument
from pointcoord.scene.scene_file import Scene
from pointcoord.simulation import require_scene
from pointcoord.sweeping.designs import Designs, designs_of, grid_of
from pointcoord.sweeping.solving import Course
from pointcoord.sweeping.swept import Sweep

MEMORY = 256e6  # bytes


def sweep(
    designs: Scene | Designs,
    points: Mapping[str, ArrayLike] | None = None,
    *,
    offsets: Mapping[str, ArrayLike] | None = None,
    grid: bool = False,
) -> Sweep:
    """Solve many designs of one suspension by point coordinates, at the instants of their scene.

    Args:
        designs: the scene whose points vary, or designs of `designs_of` or `grid_of`.
        points: positions of each point in all designs, (D, 3), mm; or values of a coordinate, such as
            lower_ball_joint.z, (D,). One position or number holds for all designs. A rack_centre that is
            drawn at tie_rod_inner moves with tie_rod_inner.
        offsets: positions or values relative to the drawing of the scene.
        grid: whether to solve every combination of the values, which are then given by coordinate.
    Returns:
        Every number with the design axis first. The numbers of a design that cannot be solved are NaN, and
        `failures` states why; the other designs are not affected.
    Raises:
        UnknownName: no point or axis has this name.
        WrongArgument: the values do not make designs, or their results do not fit into this machine's memory.
        SceneError: the scene was changed after it was read and is wrong.
        InputOutOfRange: a law, which all designs share, leaves the range of an input.

    >>> from pointcoord import Scene
    >>> found = sweep(Scene.load("double-wishbone"), offsets={"lower_ball_joint.z": [-5.0, 0.0, 5.0]})
    >>> found.position["wheel_centre"].shape
    (3, 101, 3)
    >>> found.failures
    mappingproxy({})
    """
    course = Course.of(_designs(designs, points, offsets, grid))
    count, room = course.designs.count, _physical_memory()
    needed = count * course.bytes_of_a_design
    if needed > room:
        raise WrongArgument(
            "the sweep",
            f"has {count} designs, whose numbers take {needed / 1e9:.3g} GB",
            f"what fits into this machine's {room / 1e9:.3g} GB; use sweep_blocks, which takes any number",
        )
    return course.solve(0, count)


def sweep_blocks(
    designs: Scene | Designs,
    points: Mapping[str, ArrayLike] | None = None,
    *,
    offsets: Mapping[str, ArrayLike] | None = None,
    grid: bool = False,
    memory: float = MEMORY,
) -> Iterator[Sweep]:
    """Solve any number of designs in blocks of consecutive designs, with the memory of one block.

    Args:
        designs, points, offsets, grid: see `sweep`.
        memory: most bytes for a block and for solving it. A block that is still held when the next one is
            requested takes its memory in addition.
    Raises:
        WrongArgument: see `sweep`; or one design takes more memory than that.

    >>> from pointcoord import Scene
    >>> blocks = sweep_blocks(Scene.load("steer"), offsets={"strut_top.y": [0.0, 1.0]}, memory=100e6)
    >>> sum(len(block) for block in blocks)
    2
    """
    course = Course.of(_designs(designs, points, offsets, grid))
    needed = course.bytes_of_a_design + course.bytes_on_the_way
    if needed > memory:
        raise WrongArgument(
            "memory",
            f"is {memory / 1e6:.4g} MB, but one design of {len(course.scene.instants)} instants takes "
            f"{needed / 1e6:.4g} MB",
            "more memory, or fewer instants",
        )
    # Half of the memory for the numbers of a block, half for solving.
    solving = max(0.5 * memory, course.bytes_on_the_way)
    size, count = int(max((memory - solving) // course.bytes_of_a_design, 1)), course.designs.count
    return (course.solve(first, min(first + size, count), solving) for first in range(0, count, size))


def _designs(
    designs: Scene | Designs,
    points: Mapping[str, ArrayLike] | None,
    offsets: Mapping[str, ArrayLike] | None,
    grid: bool,
) -> Designs:
    if isinstance(designs, Designs):
        if points or offsets or grid:
            problem = "are given in addition to designs, which have points of their own"
            raise WrongArgument("points", problem, "a scene with these")
        return designs
    require_scene(designs)
    return (grid_of if grid else designs_of)(designs, points, offsets)


def _physical_memory() -> float:
    """Bytes of memory of this machine; infinite where the system does not report them."""
    try:
        return float(os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE"))
    except (AttributeError, OSError, ValueError):
        return float("inf")
