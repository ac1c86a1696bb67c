"""What explains a file over inputs or a travel: first a column that is meant otherwise, then other faults."""

from collections.abc import Callable

import numpy as np
import pytest
from curve_files import at_inputs, compared, table

from pointcoord import Scene, designs_of, simulate
from pointcoord.drawing_stands import drawn_inputs
from pointcoord.numerics.arrays import Array
from validate.comparison.compare import Explanation

Columns = dict[str, Array]
CAR = Scene.load("double-wishbone")
HOME = drawn_inputs(CAR)["arm_angle"]
RACK, ANGLE, RISE = "input.rack [mm]", "input.arm_angle [rad]", "travel.wheel_centre [mm]"
GOES = {RACK: "rack", ANGLE: "arm_angle", RISE: "wheel_travel"}
ENDS = {RACK: (-40.0, 43.7), ANGLE: (HOME - 0.12, HOME + 0.1), RISE: (-50.0, 50.0)}
ROWS = 19
AT = {over: np.linspace(*ends, ROWS) for over, ends in ENDS.items()}


def numbers(over: str, car: Scene = CAR) -> Columns:
    """A car's angles and its wheel's place where one input goes evenly from end to end."""
    still = {"rack": (0.0, 0.0)} | ({} if over == RISE else {"arm_angle": (HOME, HOME)})
    found = at_inputs(car, still | {GOES[over]: ENDS[over]}, ROWS)
    angles = {f"{name} [deg]": np.degrees(angle) for name, angle in found["wheel"].items()}
    return {**angles, "position.wheel_centre.x [mm]": found["position"]["wheel_centre"][:, 0]}


def explanations(over: str, values: Array, columns: Columns, car: Scene = CAR) -> tuple[Explanation, ...]:
    """What explains a file of five decimals over a column that is exact as written."""
    exact = {"columns": {over.partition(" ")[0]: {"printed": 0}}}
    found = compared(table({over: values, **columns}, 5), exact, car).outcome
    assert not found.agreed
    return found.explanations


@pytest.mark.parametrize(
    ("over", "change", "words"),
    [
        (RACK, lambda s: -s, "rack has the other sign"),
        (RACK, lambda s: s / 25.4, "rack is taken 25.4 times"),
        (RACK, lambda s: s - 4.0, "rack is taken 4 mm more"),
        (ANGLE, lambda a: a - HOME + 1.2, f"arm_angle is taken {HOME - 1.2:.6g} rad more"),
    ],
)
def test_a_column_that_is_meant_otherwise_is_told(
    over: str, change: Callable[[Array], Array], words: str
) -> None:
    """Also where some numbers hardly change, so that their decimals say little of where a row is."""
    (first,) = explanations(over, change(AT[over]), numbers(over))
    assert first.words.endswith(f"the input {words}")
    assert (first.kind, first.leftover <= 1.0) == ("input", True)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda x, v, t: np.gradient(x, t), "rates by central differences"),
        (lambda x, v, t: v / 7.3, "0.1369863 times ours"),
    ],
)
@pytest.mark.parametrize("scene", ["double-wishbone", "off-axis-strut", "hmmwv-front"])
def test_faults_of_printed_rates_are_named(
    scene: str, change: Callable[[Array, Array, Array], Array], words: str
) -> None:
    """A difference magnifies the rounding of printed positions by one over the step."""
    motion = simulate(Scene.load(scene))
    places, rates = (motion.numbers[q]["wheel_centre"] for q in ("position", "velocity"))
    columns = {"time [s]": motion.times}
    for i, axis in enumerate("xyz"):
        columns[f"position.wheel_centre.{axis} [mm]"] = places[:, i]
        columns[f"velocity.wheel_centre.{axis} [mm/s]"] = change(places[:, i], rates[:, i], motion.times)
    (first,) = compared(table(columns, 5), {}, Scene.load(scene)).outcome.explanations
    assert first.words == f"velocity: {words}"


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda toe: -toe, ["toe: the other sign"]),
        (lambda toe: toe + 0.3, ["toe: a constant offset of 0.3 deg"]),
        (lambda toe: toe + 1e-2 * np.random.default_rng(1).standard_normal(ROWS), []),
    ],
)
@pytest.mark.parametrize("over", [RACK, RISE])
def test_a_fault_of_one_number_is_no_other_zero_and_noise_has_no_explanation(
    over: str, change: Callable[[Array], Array], words: list[str]
) -> None:
    columns = numbers(over)
    columns["toe [deg]"] = change(columns["toe [deg]"])
    found = [one.words for one in explanations(over, AT[over], columns)]
    assert [told.startswith(said) for told, said in zip(found, words, strict=True)] == [True] * len(words)


def test_a_misread_hardpoint_is_named_though_one_number_has_a_fault_of_its_own() -> None:
    """Over rows in any order."""
    car = Scene.load("bmw-e90-strut")
    columns = numbers(RISE, designs_of(car, offsets={"strut_top.x": 6.0}).design(0))
    columns["toe [deg]"] *= -1.0
    del columns["position.wheel_centre.x [mm]"]
    order = np.random.default_rng(2).permutation(ROWS)
    shuffled = {name: column[order] for name, column in columns.items()}
    hardpoint, sign = explanations(RISE, AT[RISE][order], shuffled, car)
    assert "strut_top.x seems 6 mm too far back" in hardpoint.words
    assert sign.words == "toe: the other sign"


def test_a_misread_hardpoint_is_named_by_numbers_per_travel() -> None:
    """Roll centre and bump steer are derivatives by the travel, at each row of a file over travels."""
    car = Scene.load("five-link").model_copy(update={"effects": ("roll_centre", "toe_by_travel")})
    misread = designs_of(car, offsets={"toe_inner.z": 4.0}).design(0)
    found = at_inputs(misread, {"wheel_travel": (-50.0, 50.0)}, 11)
    columns = {
        "input.wheel_travel [mm]": np.linspace(-50.0, 50.0, 11),
        "roll_centre_height [mm]": found["dimension"]["roll_centre_height"],
        "toe_by_travel [deg/mm]": np.degrees(found["angle_gradient"]["toe_by_travel"]),
    }
    first, *_ = compared(table(columns, 7), {}, car).outcome.explanations
    assert "toe_inner.z seems 4 mm too high" in first.words
