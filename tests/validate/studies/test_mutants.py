"""The study of mutants: what it makes of a small package of which every mutant's fate is known beforehand."""

import json
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from program import ENVIRONMENT

from validate.studies.mutants.changes import Change, mutants, sampled
from validate.studies.mutants.plan import Part, Plan, read_plan
from validate.studies.mutants.reasons import read_reasons
from validate.studies.mutants.store import Store
from validate.studies.mutants.trial import Verdict

SUM = '''"""A sum by a loop, and a sign that no test asks for."""

STEP = 1


def total(n: int) -> int:
    """1 + 2 + ... + n."""
    found = 0
    while n > 0:
        found += n
        n -= STEP
    return found


def opposite(x: float) -> float:
    """The other way."""
    return -x
'''
# Takes the constant by value when it is imported.
TAKEN = """from toy.sum import STEP

TAKEN = 10 * STEP
"""
TESTS = """import pytest

from toy.sum import opposite, total
from toy.taken import TAKEN


@pytest.fixture(scope="module")
def shared():
    return opposite(0.0)


def test_total():
    assert [total(n) for n in (0, 1, 4)] == [0, 1, 10]


def test_taken():
    assert TAKEN == 10


def test_opposite_of_nothing(shared):
    assert shared == 0.0
"""
MENDED = (
    TESTS
    + """

def test_opposite_of_something(shared):
    assert opposite(2.0) == -2.0
"""
)
PLAN = 'mathematics = ["toy"]\n[[part]]\nmodules = ["toy.sum"]\ntests = ["tests/test_sum.py"]\n'
# Adds a zero once more.
NOTHING_ADDED = [["while n > 0:", "while n >= 0:"], ["while n > 0:", "while n > -1:"]]
REASONS = (
    '[[equivalent]]\nmodule = "toy.sum"\nfunction = "total"\nreason = "adds a zero"\n'
    f"changes = {json.dumps(NOTHING_ADDED)}\n"
)


@pytest.fixture
def toy(tmp_path: Path) -> Path:
    for folder in ("toy", "tests"):
        (tmp_path / folder).mkdir()
    for name, text in {
        "toy/__init__.py": "",
        "toy/sum.py": SUM,
        "toy/taken.py": TAKEN,
        "tests/test_sum.py": TESTS,
        "plan.toml": PLAN,
        "reasons.toml": REASONS,
    }.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    return tmp_path


@pytest.fixture
def run(toy: Path) -> Callable[..., tuple[int, dict[str, Any], str]]:
    def run(*options: str) -> tuple[int, dict[str, Any], str]:
        command = [sys.executable, "-m", "validate.studies.mutants", "--plan", "plan.toml", "--json", "-"]
        own = ["--reasons", "reasons.toml", "--store", "store.jsonl", "--grace", "0.5"]
        done = subprocess.run(
            [*command, *own, *options], cwd=toy, env=ENVIRONMENT, capture_output=True, text=True, check=False
        )
        return done.returncode, json.loads(done.stdout or "{}"), done.stderr

    return run


def test_each_mutant_of_a_toy_meets_its_fate_and_a_mended_test_ends_the_study_well(
    toy: Path, run: Callable[..., tuple[int, dict[str, Any], str]]
) -> None:
    status, found, errors = run("--workers", "2")
    assert status == 1, errors
    fates = {(row["change"]["before"], row["change"]["after"]): row["result"] for row in found["mutants"]}
    assert fates == {
        # Both by the test of another module, which took the value.
        ("STEP = 1", "STEP = 2"): "killed",
        ("STEP = 1", "STEP = 0"): "killed",
        ("found = 0", "found = 1"): "killed",
        ("found = 0", "found = -1"): "killed",
        ("while n > 0:", "while n >= 0:"): "equivalent",
        ("while n > 0:", "while n > -1:"): "equivalent",
        ("while n > 0:", "while n > 1:"): "killed",
        ("while n > 0:", "while n <= 0:"): "hung",
        ("while n > 0:", "while not n > 0:"): "hung",
        ("found += n", "found -= n"): "killed",
        ("n -= STEP", "n += STEP"): "hung",
        ("return -x", "return x"): "survived",
    }
    assert found["not_mutated"] == ["toy.taken"]
    assert (toy / "toy" / "sum.py").read_text(encoding="utf-8") == SUM

    # Nothing is tried again, and what is known of a sample is the same.
    kept = (toy / "store.jsonl").read_bytes()
    sample = run("--sample", "3", "--seed", "5")[1]["mutants"]
    assert len(sample) == 3
    assert all(row in found["mutants"] for row in sample)
    assert (toy / "store.jsonl").read_bytes() == kept

    (toy / "tests" / "test_sum.py").write_text(MENDED, encoding="utf-8")
    stale = '[[equivalent]]\nmodule = "toy.sum"\nfunction = "opposite"\nreason = "nobody asks"\n'
    stale += 'changes = [["return -x", "return x"], ["return -x", "return +x"]]\n'
    (toy / "reasons.toml").write_text(REASONS + stale, encoding="utf-8")
    status, found, errors = run("--modules", "toy")
    assert status == 0, errors
    assert [change["after"] for change in found["stale_reasons"]] == ["return x", "return +x"]


def test_tests_that_fail_without_a_change_judge_nothing(
    toy: Path, run: Callable[..., tuple[int, dict[str, Any], str]]
) -> None:
    (toy / "tests" / "test_sum.py").write_text("def test_wrong():\n    assert 1 == 2\n", encoding="utf-8")
    status, _, errors = run()
    assert status == 2
    assert "test_wrong" in errors
    assert len(errors.splitlines()) == 1


def test_a_change_keeps_its_name_when_the_source_is_laid_out_anew() -> None:
    moved = SUM.replace("    found = 0\n", "    # A comment.\n\n    found = (\n        0\n    )\n")
    assert [m.change for m in mutants("toy.sum", SUM)] == [m.change for m in mutants("toy.sum", moved)]


def test_annotations_decorators_and_messages_are_no_mutants() -> None:
    source = '@cache(size=1)\ndef f(x: int | None) -> int | None:\n    raise Wrong(f"{x - 1:.3g}")\n'
    assert mutants("toy", source) == ()


def test_mutants_of_a_sum_of_products_are_its_operators_and_numbers() -> None:
    before = "y = 2.0 * x - z"
    after = {"y = 3.0 * x - z", "y = 1.0 * x - z", "y = 2.0 / x - z", "y = 2.0 * x + z"}
    assert {m.change for m in mutants("toy", before)} == {Change("toy", "", before, one) for one in after}


def test_the_projects_plan_and_reasons_are_read_and_speak_of_mutated_modules() -> None:
    root = Path(__file__).parents[3]
    plan = read_plan(root)
    mutated = {module for part in plan.parts for module in part.modules}
    assert {change.module for change in read_reasons()} <= mutated


def test_a_sample_is_drawn_by_name_and_grows_with_its_count() -> None:
    every = mutants("toy.sum", SUM)
    assert sampled(every, None) == every
    assert sampled(every, len(every) + 1) == every
    for count in range(1, len(every)):
        fewer, more = sampled(every, count), sampled(every, count + 1)
        assert len(fewer) == count
        assert set(fewer) < set(more)
        assert list(fewer) == [mutant for mutant in every if mutant in fewer]
    # New mutants take places, but do not bring in old ones that were not drawn.
    longer = mutants("toy.sum", SUM + "\n\ndef other(x):\n    return x + 1\n")
    old = {mutant.change for mutant in every} & {mutant.change for mutant in sampled(longer, 6)}
    assert old
    assert old <= {mutant.change for mutant in sampled(every, 6)}


def test_a_part_with_a_sample_is_tried_in_part_unless_the_whole_is_asked_for(
    toy: Path, run: Callable[..., tuple[int, dict[str, Any], str]]
) -> None:
    (toy / "plan.toml").write_text(PLAN + "sample = 2\n", encoding="utf-8")
    found = run()[1]
    assert (len(found["mutants"]), found["made"]) == (2, {"toy.sum": 12})
    assert len(run("--whole")[1]["mutants"]) == 12
    (toy / "plan.toml").write_text(PLAN + "sample = 0\n", encoding="utf-8")
    status, _, errors = run()
    assert status == 2
    assert "sample = 0" in errors


def test_what_survived_one_file_of_tests_is_tried_again_with_two_and_what_it_killed_is_not(
    tmp_path: Path,
) -> None:
    for name in ("package/__init__.py", "package/module.py", "test_one.py", "test_two.py"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text("", encoding="utf-8")
    few, more = (
        Part(("package.module",), tests) for tests in (("test_one.py",), ("test_one.py", "test_two.py"))
    )
    plan, path = Plan(tmp_path, (few, more), ()), tmp_path / "store.jsonl"
    store = Store(plan, path)
    changes = {result: Change("package.module", "", "a", result) for result in ("killed", "survived")}
    kept = {
        "killed": Verdict("killed", "test_one.py::test_it", 1.0),
        "survived": Verdict("survived", "", 1.0),
    }
    for result, change in changes.items():
        store.keep_verdict(few, change, kept[result])
    again = Store(plan, path)
    assert {result: again.verdict(few, change) for result, change in changes.items()} == kept
    assert again.verdict(more, changes["killed"]) == kept["killed"]
    assert again.verdict(more, changes["survived"]) is None


def test_a_verdict_is_of_the_tests_as_they_were_when_the_run_began(tmp_path: Path) -> None:
    for name in ("package/__init__.py", "package/module.py", "test_one.py"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text("", encoding="utf-8")
    part = Part(("package.module",), ("test_one.py",))
    plan, path = Plan(tmp_path, (part,), ()), tmp_path / "store.jsonl"
    change = Change("package.module", "", "a", "b")
    store = Store(plan, path)
    assert store.verdict(part, change) is None
    # A test that is mended while the trials of the old one go on.
    (tmp_path / "test_one.py").write_text("def test_it(): ...", encoding="utf-8")
    store.keep_verdict(part, change, Verdict("survived", "", 1.0))
    assert Store(plan, path).verdict(part, change) is None


def test_a_module_that_a_package_had_before_its_change_is_one_of_its_attributes_still(
    toy: Path, run: Callable[..., tuple[int, dict[str, Any], str]]
) -> None:
    # The package cannot be loaded without the changed module, the other module can.
    (toy / "toy" / "__init__.py").write_text(
        "import toy.other\nfrom toy.sum import total\n", encoding="utf-8"
    )
    (toy / "toy" / "other.py").write_text("NOTHING = 0.0\n", encoding="utf-8")
    tests = "import toy.other\nfrom toy.sum import opposite\n\n\ndef test_opposite():\n"
    tests += "    assert opposite(toy.other.NOTHING) == 0.0\n"
    (toy / "tests" / "test_sum.py").write_text(tests, encoding="utf-8")
    found = run()[1]
    fates = {row["change"]["before"]: (row["result"], row["by"]) for row in found["mutants"]}
    assert fates["return -x"] == ("survived", "")
