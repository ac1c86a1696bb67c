"""How each error class can be met: what raises it, parts of its message, and the data it carries."""

import importlib
import sys
from collections.abc import Callable, Mapping
from fractions import Fraction
from math import comb
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest
from flint import arb, ctx
from mechanism_drawings import described
from plain_mechanisms import design_of, solve_car

import absolute
import absolute.backend
import pointcoord
import validate.reference.route
from absolute.follow import follow
from absolute.initial_assembly import assemble
from absolute.mechanism import Mechanism
from pointcoord.effects.knuckle_rates import ByEdges
from pointcoord.linkage.hardpoints import build_mechanism
from pointcoord.mechanism import mechanism_file
from validate import assert_agrees, cli, compare
from validate.assemblies.legs import forms
from validate.cost.errors import errors_of, truth_of
from validate.cost.table import Store as RowStore
from validate.cost.table import measured_here
from validate.cost.way import Answer
from validate.cost.ways.registry import ways_named
from validate.cost.ways.scipy_solvers import WAYS as SCIPY
from validate.formulations.protocol import Accuracy, FormulationError
from validate.formulations.registry import formulation
from validate.measured.reading import columns_of_text
from validate.output.columns import write_motion
from validate.peers.in_pinocchio import InPinocchio
from validate.peers.linkage import linkage_of
from validate.reference import solve_reference
from validate.reference.certificate import certify
from validate.reference.design import values_only
from validate.reference.exact import bits
from validate.reference.krawczyk import newton
from validate.reference.route import closed
from validate.solvers.check import check
from validate.spanning_tree.cut import cut
from validate.studies import cluster
from validate.studies.study import Task

BOUNCE = pointcoord.Scene.load("bounce")
TABLE = dict(BOUNCE.mechanism.points)
COLLINEAR = mechanism_file("macpherson").topology("collinear", points=TABLE)
PAPER_CAR = BOUNCE.mechanism.plain(("arm_angle", "rack"))
HINGE_OF_ONE_POINT = {**PAPER_CAR, "points": TABLE | {"lower_arm_rear": TABLE["lower_arm_front"]}}
UPRIGHT = {"up": (0.0, 0.0, 1.0), "right": (0.0, 1.0, 0.0)}
HELD = {"arm_angle": np.array([[1.6, 0.0, 0.0]]), "rack": np.array([[0.0, 0.0, 0.0]])}
IN_LINE = {name: np.array([1.0, 2.0, 3.0]) * i for i, name in enumerate("abc")}
# The arm's axis is level and the arm stands upright: the ball joint is on top of its circle.
TOP = {"lower_arm_front": (0, 0, 0), "lower_arm_rear": (200, 0, 0), "lower_ball_joint": (0, -300, 0)}


class Recipe(NamedTuple):
    """What raises an error, parts of its message, and its attributes: values, or tests of them."""

    cook: Callable[[Path, pytest.MonkeyPatch], object]
    words: tuple[str, ...]
    data: Mapping[str, object] = {}


def changed(**sections: Mapping[str, Any]) -> pointcoord.Scene:
    """The built-in bounce with other inputs, times or points."""
    content = BOUNCE.model_dump(exclude_none=True)
    for section, changes in sections.items():
        content[section].update(changes)
    return pointcoord.Scene.from_mapping(content, "mine")


def failing_solver() -> None:
    """A solver that asks for a hardpoint that no car has."""
    try:
        check(lambda given: {"position": given["points"]["strut"]}, BOUNCE)
    except FormulationError as error:
        raise error.reason from None


def jumping() -> pointcoord.Scene:
    """The arm jumps by 0.01 rad within a nanosecond: cubics of size 1e25 that rounding cannot hold."""
    times = (0.0, 0.2, 0.5, 0.5 + 1e-9, 0.8, 1.0)
    arm = {"table": {"times": times, "values": [1.6, 1.6, 1.6, 1.61, 1.61, 1.61]}}
    return changed(inputs={"arm_angle": arm}, time={"start": 0.5 - 2e-8, "stop": 0.5 + 2e-9})


def cancelling(power_of_two: int) -> pointcoord.Scene:
    """The rack goes 16 (t - start)^6 mm, multiplied out: terms of up to 20 start^6 each cancel to that."""
    start = 2.0**power_of_two
    terms = [16.0 * comb(6, k) * (-start) ** (6 - k) for k in range(7)]
    laws = {"rack": {"polynomial": terms}, "arm_angle": {"constant": 1.6}}
    return changed(inputs=laws, time={"start": start, "stop": start + 1.0, "samples": 5})


def solved(points: Mapping[str, Any], inputs: Mapping[str, Any] = HELD) -> object:
    return absolute.solve(absolute.compile({**PAPER_CAR, "points": PAPER_CAR["points"] | points}), inputs)


def followed(angle: float) -> object:
    """The paper's car in relative coordinates, its arm at an angle."""
    linkage = linkage_of(PAPER_CAR)
    program = InPinocchio(linkage)
    laws = {"arm_angle": np.array([[angle, 0.0, 0.0]]), "rack": np.zeros((1, 3))}
    return program.poses(linkage.inputs(laws).values, 1e-10, program.closed(1e-10))


def frame_without(patch: pytest.MonkeyPatch, *libraries: str) -> object:
    for name in libraries:
        patch.setitem(sys.modules, name, None)
    return pointcoord.simulate(BOUNCE).to_dataframe()


def without_pinocchio(patch: pytest.MonkeyPatch) -> object:
    patch.setitem(sys.modules, "pinocchio", None)
    return importlib.reload(absolute.backend)


def blocked() -> object:
    """A way along which the rack goes half a metre."""
    mechanism = Mechanism(absolute.compile(PAPER_CAR))
    begin = mechanism.drawn_inputs
    return list(
        follow(mechanism, assemble(mechanism), begin, begin + np.array([[0.0, 500.0]]), mechanism.targets)
    )


def leaving_by_scipy() -> object:
    """The rack goes half a metre, which no tie rod follows."""
    scene = changed(inputs={"rack": {"polynomial": [0.0, 500.0]}, "arm_angle": {"constant": 1.6}})
    way = next(way for way in SCIPY if way.name == "scipy-root")
    return way.prepare(scene, 1e-9)(scene.instants)


# An arm of 300 mm driven by the height of its end, which is singular at 300.
UPRIGHT_ARM = described(
    {"front": (-100, 0, 0), "rear": (100, 0, 0), "end": (0, -300, 0)},
    {"chassis": ["front", "rear"], "arm": ["front", "rear", "end"]},
    {"height": {"height": "end"}},
)


def uncertified() -> object:
    """One coordinate of an assembly moved by ten times the box that is to hold the assembly."""
    with ctx.workprec(bits(60)):
        design = design_of(TABLE, closure="collinear")
        known = values_only(design.known_as_drawn())
        assembled, _ = newton(known.system, closed(design).pose.unknown)
        assembled[0] = (assembled[0] + arb("1e-59")).mid()
        return certify(assembled, known, Fraction(1, 10**60))


def in_no_step(patch: pytest.MonkeyPatch) -> object:
    """A way that is given up before its first step."""
    patch.setattr(validate.reference.route, "MOST_STEPS", 0)
    return solve_car(TABLE, {"arm_angle": (1.1, 0, 0)})


RECIPES: dict[str, Recipe] = {
    "pointcoord.errors.SceneError": Recipe(
        lambda *_: changed(time={"stop": -1.0}),
        ("mine: time:", "-1.0", "allowed: start < stop"),
        {"source": "mine", "key": "time"},
    ),
    "pointcoord.errors.UnknownName": Recipe(
        lambda *_: pointcoord.simulate(BOUNCE).position["wheel_center"],
        ("wheel_center", "did you mean 'wheel_centre'?", "lower_arm_front"),
        {"kind": "position", "name": "wheel_center", "valid": lambda names: "wheel_centre" in names},
    ),
    "pointcoord.errors.NotComputed": Recipe(
        lambda *_: pointcoord.simulate(BOUNCE.model_copy(update={"effects": ()})).wheel["camber"],
        ("camber was not computed", "add 'camber'"),
        {"effect": "camber", "quantity": lambda name: "camber" in name},
    ),
    "pointcoord.errors.MissingLibrary": Recipe(
        lambda _, pretend: frame_without(pretend, "pandas", "polars"),
        ("pandas or polars", "is not installed", "pip install 'pointcoord[pandas]'", "pointcoord[polars]"),
        {"part": "a data frame", "libraries": ("pandas", "polars")},
    ),
    "pointcoord.errors.MechanismError": Recipe(
        lambda *_: build_mechanism(COLLINEAR, {**TABLE, "strut_lower": TABLE["lower_ball_joint"]}, UPRIGHT),
        ("link", "lower_ball_joint", "strut_lower", "no length", "move one"),
        {"names": lambda names: set(names) == {"lower_ball_joint", "strut_lower"}, "problem": bool},
    ),
    "pointcoord.errors.InputOutOfRange": Recipe(
        lambda *_: pointcoord.simulate(changed(inputs={"arm_angle": {"constant": 3.5}})),
        ("input 'arm_angle' is 3.5 at t = 0 s", "allowed: 0 to pi rad"),
        {"name": "arm_angle", "value": 3.5, "instant": 0.0, "allowed": bool},
    ),
    "pointcoord.errors.InputNotKnown": Recipe(
        lambda *_: pointcoord.simulate(cancelling(15)),
        ("input 'rack' is not known at t = 32768 s", "its polynomial cancel to 0", "off by 3.1", "a table"),
        {"name": "rack", "law": "polynomial", "value": 0.0, "doubt": lambda doubt: 3.0 < doubt < 3.2},
    ),
    "pointcoord.errors.AssemblyError": Recipe(
        lambda *_: pointcoord.simulate(
            changed(inputs={"rack": {"polynomial": (0.0, 100.0)}, "arm_angle": {"constant": 1.6}})
        ),
        ("t = ", "wanted", "rack = ", "stopped at", "condition number", "tie_rod", "bring 'rack' back"),
        {
            "reduce": "rack",
            "reached": lambda values: 0.0 < values["rack"] < 260.0,
            "instant": np.isfinite,
            "limits": lambda links: any("tie_rod" in link for link in links),
            "partial": lambda motion: isinstance(motion, pointcoord.Motion) and len(motion.times) > 1,
        },
    ),
    "pointcoord.errors.MotionTooLong": Recipe(
        lambda _, pretend: (
            pretend.setattr("pointcoord.solve.taylor.MOST_SEGMENTS", 5),
            pointcoord.simulate(changed(inputs={"rack": {"polynomial": (0.0, *[1e-6] * 30)}}), "series"),
        ),
        ("from 0 to 2.6 s", "segments; allowed: 5", "reach t = ", "slow the inputs down", "'newton'"),
        {"limit": 5, "stop": 2.6, "instant": np.isfinite, "partial": bool},
    ),
    "pointcoord.errors.MotionTooRough": Recipe(
        lambda *_: pointcoord.simulate(jumping(), "series"),
        ("input 'arm_angle' changes too fast", "after t = 0.4999999", "'newton'"),
        {"name": "arm_angle", "instant": 0.5 - 2e-8, "partial": lambda motion: motion is None},
    ),
    "pointcoord.errors.MotionNotMapped": Recipe(
        lambda _, pretend: (
            pretend.setattr("pointcoord.patches.way_map.ENOUGH", 0),
            pointcoord.simulate(BOUNCE, "map"),
        ),
        ("does not cover their way after t = 0 s", "arm_angle = 0.8", "the most patches", "'newton'"),
        {
            "instant": 0.0,
            "inputs": lambda inputs: set(inputs) == {"arm_angle", "rack"},
            "reason": bool,
            "partial": lambda motion: motion is None,
        },
    ),
    "pointcoord.errors.SingularConfiguration": Recipe(
        lambda *_: ByEdges().rates(IN_LINE, IN_LINE, IN_LINE),
        ("in one line", "turn about that line is free", "condition number", "move an input or a point"),
        {"free": bool, "condition": lambda number: number > 1e14},
    ),
    "pointcoord.errors.OutsideMotion": Recipe(
        lambda *_: pointcoord.simulate(BOUNCE).at(2.7),
        ("t = 2.7 s is outside", "allowed: 0 to 2.6 s"),
        {"instant": 2.7, "start": 0.0, "stop": 2.6},
    ),
    "pointcoord.errors.WrongArgument: of a map": Recipe(
        lambda *_: pointcoord.kinematic_map(BOUNCE, {"arm_angle": (1.0, 0.9), "rack": (0.0, 1.0)}),
        ("ranges['arm_angle'] is (1.0, 0.9)", "allowed: two finite numbers within 1e+12, the lower first"),
        {"what": "ranges['arm_angle']", "problem": "is (1.0, 0.9)", "allowed": bool},
    ),
    "pointcoord.errors.WrongArgument: of a sweep": Recipe(
        lambda *_: pointcoord.sweep(BOUNCE, {"strut_top.x": [1.0, 2.0], "strut_top.y": [1.0, 2.0, 3.0]}),
        ("strut_top.x has 2 values where strut_top.y has 3", "as many of each"),
        {"what": "strut_top.x", "problem": bool, "allowed": "as many of each"},
    ),
    "pointcoord.errors.NotCovered": Recipe(
        # One box of a range that reaches beyond what the links allow, and not to be cut.
        lambda *_: pointcoord.kinematic_map(
            BOUNCE, {"arm_angle": (0.5, 2.5), "rack": (-90.0, 90.0)}, halvings=0
        ),
        ("the map does not cover arm_angle = ", "a fold", "make the map of a smaller range"),
        {
            "inputs": lambda inputs: set(inputs) == {"arm_angle", "rack"},
            "reason": bool,
            "count": 1,
            "asked": 1,
        },
    ),
    "absolute.follow.BlockedError": Recipe(
        lambda *_: blocked(),
        ("blocked at [",),
        {
            "reached": lambda inputs: 0.0 < inputs[1] < 500.0,
            "pose": lambda pose: pose is not None,
            "corrections": bool,
        },
    ),
    "validate.tables.errors.FileError": Recipe(
        lambda *_: columns_of_text("time,camber\n0,1.2\n1,l.3\n", "mine.csv"),
        ("mine.csv: line 3, column 'camber'", "'l.3' is no finite number", "allowed: a number"),
        {"source": "mine.csv", "place": "line 3, column 'camber'", "problem": bool, "allowed": bool},
    ),
    "validate.peers.errors.HardpointsError": Recipe(
        lambda *_: linkage_of(HINGE_OF_ONE_POINT),
        ("lower_arm_front is where lower_arm_rear is", "allowed: points apart"),
        {"name": "lower_arm_front", "allowed": bool},
    ),
    "validate.peers.errors.InputError": Recipe(
        lambda *_: followed(3.5),
        ("input 'arm_angle' is 3.5 at instant number 0", "allowed: an angle from 0 to pi"),
        {"name": "arm_angle", "value": 3.5, "instant": 0},
    ),
    "validate.peers.errors.PoseError": Recipe(
        lambda *_: followed(3.0),
        (
            "instant number 0 cannot be reached",
            "wanted arm_angle = 3",
            "reached arm_angle = 2.6",
            "try inputs",
        ),
        {
            "instant": 0,
            "wanted": lambda inputs: inputs["arm_angle"] == 3.0,
            "reached": lambda inputs: 2.6 < inputs["arm_angle"] < 2.7,
            "condition": lambda condition: condition > 1e3,
            "partial": None,
        },
    ),
    "absolute.errors.DescriptionError": Recipe(
        lambda *_: solved({"strut_top": (1.0, float("nan"), 2.0)}),
        ("point 'strut_top'", "nan", "three finite numbers"),
        {"name": "strut_top", "value": lambda value: len(value) == 3},
    ),
    "absolute.errors.InputError": Recipe(
        lambda *_: solved({}, {**HELD, "rack": np.array([[0.0, np.inf, 0.0]])}),
        ("rack", "inf", "instant 0", "finite"),
        {"name": "rack", "instant": 0},
    ),
    "absolute.errors.AssemblyError": Recipe(
        lambda *_: solved({"rack_centre": (570, 60, 2000)}),
        ("the drawing cannot be assembled", "mm", "draw the points closer"),
        {"instant": None, "residual": np.isfinite, "inputs": bool, "condition": np.isfinite},
    ),
    "validate.formulations.protocol.AccuracyError": Recipe(
        lambda *_: Accuracy(
            condition=np.ones(2), claims={"position": {"wheel_centre": np.full((2, 3), -1.0)}}
        ),
        ("position of wheel_centre", "-1", "finite numbers from 0 up"),
        {"claim": "position of wheel_centre", "problem": bool, "allowed": bool},
    ),
    "absolute.errors.MissingPinocchioError": Recipe(
        lambda _, patch: without_pinocchio(patch),
        ("Pinocchio", "pip install 'pointcoord[validate]'"),
        {},
    ),
    "absolute.errors.UnreachableError": Recipe(
        lambda *_: solved({}, {**HELD, "rack": np.array([[500.0, 0.0, 0.0]])}),
        ("instant 0", "rack = 500", "locks at", "condition number", "Keep the inputs inside"),
        {
            "instant": 0,
            "inputs": lambda inputs: inputs["rack"] == 500.0,
            "reached": lambda inputs: inputs["rack"] < 260.0,
        },
    ),
    "absolute.errors.SingularError": Recipe(
        # The ball joint is on the axis that it turns about; the strut is drawn along its own line.
        lambda *_: solved(
            {"lower_ball_joint": (432, -8, -16), "strut_lower": (434.8, -25.2, 32.6)}
            | {"strut_rod_end": (446, -94, 227)}
        ),
        ("singular", "condition number", "can be solved", "Look for points on one line"),
        {"instant": None, "condition": lambda number: number > 1e12, "inputs": bool},
    ),
    "validate.cli.Answer": Recipe(lambda *_: cli._parsed(["--version"]), ("pointcoord ",)),
    "validate.errors.UsageError": Recipe(
        lambda *_: cli._parsed(["simulat", "bounce"]),
        ("simulat", "did you mean 'simulate'?", "pointcoord --help"),
    ),
    "validate.studies.study.StudyStopped": Recipe(
        lambda *_: cluster.rows_of(lambda task: [][task.number], Task("held", 7), "here"),
        ("held 7: IndexError: ",),
    ),
    "validate.cost.table.StoreError": Recipe(
        lambda folder, _: RowStore(folder, measured_here()), ("cannot be read", "directory", "another file")
    ),
    "validate.cost.way.LeftOut": Recipe(
        lambda *_: ways_named(["printed"])[0].prepare(pointcoord.Scene.load("double-wishbone"), 1e-9),
        ("the strut that the paper prints",),
    ),
    "validate.cost.race.NoNumbers": Recipe(
        lambda *_: errors_of(Answer({}), truth_of(BOUNCE, BOUNCE.instants[:1])), ("gives no position",)
    ),
    "validate.formulations.protocol.FormulationError": Recipe(
        lambda *_: compare(changed(inputs={"rack": {"constant": 500.0}}), "pointcoord", "absolute"),
        ("pointcoord: ", "rack = 500", "bring 'rack' back"),
        {"formulation": "pointcoord", "reason": lambda it: isinstance(it, pointcoord.AssemblyError)},
    ),
    "validate.solvers.plain.NoSolver": Recipe(
        lambda *_: check(3.0, BOUNCE),
        ("the solver is of type float", "give a function, or an object or a class with a method 'solve'"),
        {"what": "the solver"},
    ),
    "validate.solvers.plain.SolverFailed": Recipe(
        lambda *_: failing_solver(), ("KeyError: 'strut'", "error_recipes.py:"), {}
    ),
    "validate.testing.assertion.WrongStates": Recipe(
        lambda *_: assert_agrees({"camber": np.zeros(3)}, BOUNCE),
        ("the states: wheel angle of camber has the shape (3,); needed: (131,)",),
        {"faults": bool},
    ),
    "validate.testing.assertion.NotTested": Recipe(
        lambda *_: assert_agrees({"camber": np.zeros(len(BOUNCE.instants))}, BOUNCE, accuracy=1e3),
        ("not tested in", "camber", "an accuracy of 1000 mm says nothing", "state a finer accuracy"),
        {"accuracy": 1e3, "scene": BOUNCE.title, "numbers": ("camber",)},
    ),
    "validate.extras.MissingPackage": Recipe(
        lambda _, pretend: (
            pretend.delitem(sys.modules, "validate.formulations.absolute_coordinates", raising=False),
            pretend.setitem(sys.modules, "absolute", None),
            formulation("absolute"),
        ),
        ("'absolute' needs the package", "not installed", "pip install 'pointcoord[validate]'"),
        {"part": "absolute", "package": "absolute"},
    ),
    "validate.peers.errors.PeerError": Recipe(
        lambda *_: ways_named(["relative"])[0].prepare(pointcoord.Scene.load("steer"), 1e-9)(
            np.array([0.1, 1e9])
        ),
        ("at t = 1e+09 s", "reached"),
        {"problem": bool, "instant": 1},
    ),
    "validate.spanning_tree.cut.CutError": Recipe(
        lambda *_: cut(HINGE_OF_ONE_POINT),
        ("lower_arm_front is where lower_arm_rear is", "allowed: points apart"),
        {"name": "lower_arm_front", "problem": bool, "allowed": bool},
    ),
    "validate.cost.ways.scipy_solvers.SolverStopped": Recipe(
        lambda *_: leaving_by_scipy(),
        ("scipy.optimize.root at t = ", "not making good progress"),
        {"solver": "root", "instant": lambda instant: instant >= 0.0},
    ),
    "validate.output.files.OutputError": Recipe(
        lambda folder, _: write_motion(str(folder / "no" / "x.csv"), pointcoord.simulate(BOUNCE)),
        ("x.csv: cannot be written", "there is no folder"),
        {"target": lambda name: name.endswith("x.csv"), "problem": bool},
    ),
    "validate.assemblies.legs.NotOnLegsError": Recipe(
        lambda *_: forms({"roles": {}}, {}),
        ("names no knuckle", "whose role is not given"),
    ),
    "validate.reference.errors.NoReferenceError": Recipe(
        lambda *_: solve_car(
            {**TABLE, "wheel_centre": TABLE["strut_lower"]}, {"arm_angle": (1.5, 0, 0)}
        ).effect("camber"),
        ("camber cannot be proven", "where it is 0/0"),
    ),
    "validate.reference.errors.BadInputError": Recipe(
        lambda *_: solve_car(TABLE, {"arm_angle": (1.5, 0, 0)}, side="middle"),
        ("side is 'middle'", "allowed is 'left' or 'right'"),
        {"what": "side", "value": "middle", "allowed": bool},
    ),
    "validate.reference.errors.InfeasibleError": Recipe(
        lambda *_: solve_car(TABLE, {"arm_angle": (1.5, 0, 0), "rack": (500, 0, 0)}),
        ("turns back at a fold", "needed 1", "rack = ", "nearer those of the drawing"),
        {"way": bool, "share": lambda share: 0.0 < share < 1.0, "inputs": bool},
    ),
    "validate.reference.errors.AmbiguousAssemblyError": Recipe(
        lambda *_: solve_car({**TABLE, **TOP, "lower_ball_joint": (0, 0, -300)}, {"arm_angle": (3.0, 0, 0)}),
        ("drawn at a singular pose", "limit"),
        {"what": bool, "value": np.isfinite, "limit": np.isfinite},
    ),
    "validate.reference.errors.NotDecidedError": Recipe(
        lambda *_: uncertified(), ("limit",), {"what": bool, "value": bool, "limit": bool}
    ),
    "validate.reference.errors.SingularPoseError": Recipe(
        lambda *_: solve_reference(UPRIGHT_ARM, {"height": (300, 1, 0)}),
        ("no certificate with 400 digits", "dead point", "move an input"),
        {"digits": 400, "reason": lambda reason: type(reason).__name__ == "NotDecidedError"},
    ),
    "validate.reference.errors.TooManyStepsError": Recipe(
        lambda _, patch: in_no_step(patch),
        ("is given up after", "nothing is said of the pose"),
        {"way": bool, "share": np.isfinite, "steps": 0},
    ),
}
