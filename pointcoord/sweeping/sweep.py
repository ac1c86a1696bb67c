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
        points: by point where each design draws it, (D, 3), mm, or by coordinate, such as lower_ball_joint.z,
            (D,). What is given once holds for all designs. A rack_centre that is drawn where tie_rod_inner is
            goes along with it.
        offsets: the same, measured from where the scene draws it.
        grid: whether to take every combination of the values of each coordinate, given by coordinate.
    Returns:
        Every number with the design axis first. A design that cannot be solved has NaN and says why in
        `failures`; it disturbs no other.
    Raises:
        UnknownName: no point or axis is called so.
        WrongArgument: the values do not make designs, or their results do not fit into this machine's memory.
        SceneError: the scene was made wrong after it was read.
        InputOutOfRange: a law that all designs share.

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
    """The same in blocks of consecutive designs: any number of them, in a block's memory.

    Args:
        memory: bytes that a block and solving it take at most; one that is still held when the next is asked
            for comes to that.
    Raises:
        WrongArgument: as `sweep`; or one design takes more memory than that.

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
            f"is {memory / 1e6:.4g} MB, where one design of {len(course.scene.instants)} instants takes "
            f"{needed / 1e6:.4g} MB",
            "more memory, or fewer instants",
        )
    # Half for the numbers of a block and half for what is solved together.
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
            problem = "are given beside designs that have their own"
            raise WrongArgument("points", problem, "a scene with these")
        return designs
    require_scene(designs)
    return (grid_of if grid else designs_of)(designs, points, offsets)


def _physical_memory() -> float:
    """Bytes of this machine; without bound where it does not say."""
    try:
        return float(os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE"))
    except (AttributeError, OSError, ValueError):
        return float("inf")
