"""Tests of a changed module, each trial in a process of its own, forked from one that has loaded the rest.

Trials begin in a copy of an interpreter that has loaded what the tests need but the mutated module and all
that imports it. These are imported in the trial itself, from the changed source, so that a change of a
constant, a class or a function is a change for everybody. Nothing is written into the tree.

A trial runs the tests that run the changed statement, the quickest first, and ends with the first that fails.
Which these are is measured before, without a change, test by test. What a fixture that several tests share
runs counts for all of them, and what an import runs for all tests of the part.
"""

from __future__ import annotations

import contextlib
import gc
import importlib
import importlib.abc
import importlib.machinery
import importlib.util
import json
import os
import resource
import select
import signal
import sys
import time
from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any, NoReturn

from validate.commands.usage import UsageError
from validate.extras import MissingPackage
from validate.studies.mutants.changes import Mutant, source_of
from validate.studies.mutants.plan import Part, Plan

if TYPE_CHECKING:
    from validate.studies.mutants.watching import Measuring, Trial

SHARED = ""  # the name under which what is not one test's alone is counted

# A trial may take so many times the processor time that its tests took unchanged, that of starting, and some
# seconds more; and on the clock of a busy machine so many times that.
PATIENCE, CLOCK = 4.0, 20.0
MEMORY = 8 << 30  # bytes; a change may ask for an array of any size


@dataclass(frozen=True)
class Baseline:
    """What the tests of a part do without a change.

    Attributes:
        seconds: of processor time of each test by its id; by SHARED of starting and collecting.
        lines: the tests that run each line of each module; SHARED where it is not one test's alone.
        loaded: the modules that were loaded in the end, in their order.
    """

    seconds: Mapping[str, float]
    lines: Mapping[str, Mapping[int, tuple[str, ...]]]
    loaded: tuple[str, ...]

    def tests(self, module: str, where: range) -> list[str]:
        """The tests that run some lines: their own ones first, the quickest first."""
        known = self.lines.get(module, {})
        named = {test for line in where for test in known.get(line, ())}
        own = named - {SHARED}
        others = self.seconds.keys() - own - {SHARED} if SHARED in named else ()
        return [
            *sorted(own, key=lambda test: self.seconds[test]),
            *sorted(others, key=lambda test: self.seconds[test]),
        ]

    def document(self) -> dict[str, Any]:
        """As JSON keeps it."""
        return asdict(self)

    @classmethod
    def of(cls, document: Mapping[str, Any]) -> Baseline:
        """From what JSON kept."""
        lines = {
            module: {int(line): tuple(tests) for line, tests in known.items()}
            for module, known in document["lines"].items()
        }
        return cls(dict(document["seconds"]), lines, tuple(document["loaded"]))


@dataclass(frozen=True)
class Verdict:
    """What became of a mutant.

    Attributes:
        result: "killed", "hung" (out of time, and so noticed), or "survived".
        by: the test that failed, or what else ended the trial.
        seconds: of processor time.
    """

    result: str
    by: str
    seconds: float


def measure(plan: Plan, part: Part) -> Baseline:
    """Run the tests of a part without a change.

    Raises:
        UsageError: one of them fails. MissingPackage: pytest or coverage is not installed.
    """
    for needed in ("pytest", "coverage"):
        if importlib.util.find_spec(needed) is None:
            raise MissingPackage("mutants", ModuleNotFoundError(name=needed), "mutants")
    from validate.studies.mutants.watching import Measuring

    answer, _, ended = next(_forked([lambda: _measured(plan, part, Measuring)], [None], 1))
    if not answer or "by" in answer:
        by = answer["by"] if answer else f"{' '.join(part.tests)} ({ended})"
        raise UsageError(f"{by}: fails without a change, so that no mutant can be judged; try: pytest {by!r}")
    return Baseline.of(answer)


def tried(
    plan: Plan, module: str, baseline: Baseline, mutants: Sequence[Mutant], workers: int, grace: float
) -> Iterator[tuple[Mutant, Verdict]]:
    """Each mutant of a module with what became of it, as the verdicts come.

    Args:
        workers: trials at a time. grace: seconds of processor time that any trial has beyond its tests'.
    """
    # Imported here: in the copy that forgets the packages it would bring them back before their change.
    from validate.studies.mutants.watching import Trial

    tests = {mutant: baseline.tests(module, mutant.lines) for mutant in mutants}
    wanted = [mutant for mutant in mutants if tests[mutant]]
    for mutant in mutants:
        if not tests[mutant]:
            yield mutant, Verdict("survived", "no test runs it", 0.0)

    def serve(reply: Callable[[Any], None]) -> None:
        _load(plan, module, baseline)
        left = list(range(len(wanted)))
        spent: dict[int, float] = dict.fromkeys(left, 0.0)
        # Most mutants are noticed by the first few tests: the other files need not even be read.
        for first in (True, False):
            chosen = [_of_first_file(tests[wanted[i]], baseline, first) for i in left]
            limits = [_limit(some, baseline, grace) for some in chosen]
            sources = [wanted[i].source for i in left]
            actions = [
                partial(_trial, plan, module, source, Trial(some))
                for source, some in zip(sources, chosen, strict=True)
            ]
            survived = []
            for found, k, ended in _forked(actions, limits, workers):
                if found.get("unchanged"):
                    raise RuntimeError(f"{module} was loaded before its change")
                spent[left[k]] += found.get("seconds", limits[k])
                by = found["by"] if found else ended
                if by or not first:
                    result = "survived" if not by else "hung" if by == OUT_OF_TIME else "killed"
                    reply({"index": left[k], "result": result, "by": by, "seconds": spent[left[k]]})
                else:
                    survived.append(left[k])
            left = sorted(survived)

    if wanted:
        answers = 0
        for answer in _served(serve):
            answers += 1
            yield wanted[answer["index"]], Verdict(answer["result"], answer["by"], answer["seconds"])
        if answers < len(wanted):
            raise RuntimeError(f"{module}: the trials ended after {answers} of {len(wanted)} mutants")


def _of_first_file(tests: Sequence[str], baseline: Baseline, first: bool) -> list[str]:
    """The tests of the file that takes the least time for its share of them, or all others."""
    seconds: defaultdict[str, float] = defaultdict(float)
    for test in tests:
        seconds[test.split("::")[0]] += baseline.seconds[test]
    quickest = min(seconds, key=lambda file: seconds[file])
    return [test for test in tests if (test.split("::")[0] == quickest) is first]


def _limit(tests: Iterable[str], baseline: Baseline, grace: float) -> float:
    """How much processor time some tests may take, s."""
    return grace + baseline.seconds[SHARED] + PATIENCE * sum(baseline.seconds[test] for test in tests)


OUT_OF_TIME = "out of time"


def _forked(
    actions: Sequence[Callable[[], dict[str, Any]]], limits: Sequence[float | None], workers: int
) -> Iterator[tuple[dict[str, Any], int, str]]:
    """What each action returns in a copy of this process; empty, and why, where the copy ended without."""
    waiting = list(range(len(actions)))[::-1]
    running: dict[int, tuple[int, int, float, bytearray]] = {}
    while waiting or running:
        while waiting and len(running) < workers:
            index = waiting.pop()
            reader, writer = os.pipe()
            sys.stdout.flush()
            sys.stderr.flush()
            process = os.fork()
            if not process:
                os.close(reader)
                _alone(actions[index], limits[index], writer)
            os.close(writer)
            ends = time.monotonic() + CLOCK * (limits[index] or 1e9)
            running[reader] = (index, process, ends, bytearray())
        ready, _, _ = select.select(list(running), [], [], 1.0)
        for reader in list(running):
            index, process, ends, data = running[reader]
            if reader in ready and (piece := os.read(reader, 1 << 20)):
                data += piece
                continue
            late = time.monotonic() > ends
            if reader not in ready and not late:
                continue
            if late:
                with contextlib.suppress(ProcessLookupError):
                    os.killpg(process, signal.SIGKILL)
            os.close(reader)
            del running[reader]
            _, status = os.waitpid(process, 0)
            number = os.WTERMSIG(status) if os.WIFSIGNALED(status) else 0
            ended = f"signal {number}" if number else "the interpreter ended"
            if late or number == signal.SIGXCPU:
                ended = OUT_OF_TIME
            yield json.loads(data) if data and not late and not number else {}, index, ended


def _alone(action: Callable[[], dict[str, Any]], limit: float | None, writer: int) -> NoReturn:
    """In the copy: be a group of processes of its own, keep to the limits, answer, end."""
    try:
        os.setpgid(0, 0)
        nothing = os.open(os.devnull, os.O_RDWR)
        for stream in (0, 1, 2):
            os.dup2(nothing, stream)
        if limit is not None:
            resource.setrlimit(resource.RLIMIT_CPU, (round(limit) + 1, round(limit) + 5))
            resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
        answer = json.dumps(action()).encode()
        while answer:
            answer = answer[os.write(writer, answer) :]
    finally:
        os._exit(0)


def _served(serve: Callable[[Callable[[Any], None]], None]) -> Iterator[Any]:
    """Each object that `serve` replies with, from a copy of this process."""
    reader, writer = os.pipe()
    sys.stdout.flush()
    sys.stderr.flush()
    process = os.fork()
    if not process:
        try:
            os.close(reader)
            with os.fdopen(writer, "w", encoding="utf-8") as lines:
                serve(lambda answer: print(json.dumps(answer), file=lines, flush=True))
        except BaseException:
            sys.excepthook(*sys.exc_info())
        finally:
            os._exit(0)
    os.close(writer)
    with os.fdopen(reader, encoding="utf-8") as answers:
        try:
            yield from map(json.loads, answers)
        finally:
            with contextlib.suppress(ProcessLookupError):
                os.kill(process, signal.SIGTERM)
            os.waitpid(process, 0)


def _forget(plan: Plan) -> None:
    """The packages of the checkout are imported anew, and from it."""
    for name in list(sys.modules):
        if name.split(".")[0] in plan.packages:
            del sys.modules[name]
    sys.path[:] = [str(plan.root), *(path for path in sys.path if path not in ("", str(plan.root)))]
    importlib.invalidate_caches()


def _load(plan: Plan, module: str, baseline: Baseline) -> None:
    """Load what the tests need, except for a module and what cannot be imported without it."""
    _forget(plan)
    os.chdir(plan.root)
    without = Withheld(module)
    sys.meta_path.insert(0, without)
    for name in baseline.loaded:
        with contextlib.suppress(Exception):
            importlib.import_module(name)
    sys.meta_path.remove(without)
    # What is loaded is passed over whenever a trial collects its garbage, and stays shared between processes.
    gc.collect()
    gc.freeze()


def _trial(plan: Plan, module: str, source: str, trial: Trial) -> dict[str, Any]:
    """Run tests with a changed source of a module: the test that fails, or nothing."""
    if not trial.order:
        return {"by": "", "seconds": 0.0}
    started = time.process_time()
    changed = ChangedModule(module, source_of(plan.root, module), source)
    sys.meta_path.insert(0, changed)
    _join_packages(plan)
    by = _pytest(plan, sorted({test.split("::")[0] for test in trial.order}), trial)
    loaded = sys.modules.get(module)
    unchanged = loaded is not None and loaded.__loader__ is not changed
    return {"by": by, "seconds": time.process_time() - started, "unchanged": unchanged}


def _join_packages(plan: Plan) -> None:
    """Packages that are imported anew have their modules that were loaded before as attributes again.

    Importing a module that is loaded does not make it one: `import package.module` would fail to be read.
    """
    for name, module in list(sys.modules.items()):
        parent, _, last = name.rpartition(".")
        if parent and name.split(".")[0] in plan.packages and parent not in sys.modules:
            # What the change breaks is told when the tests import it.
            with contextlib.suppress(Exception):
                setattr(importlib.import_module(parent), last, module)
        elif parent and name.split(".")[0] in plan.packages and not hasattr(sys.modules[parent], last):
            setattr(sys.modules[parent], last, module)


def _measured(plan: Plan, part: Part, plugin: type[Measuring]) -> dict[str, Any]:
    from coverage import Coverage

    _forget(plan)
    os.chdir(plan.root)
    files = {module: str(source_of(plan.root, module)) for module in part.modules}
    coverage = Coverage(data_file=None, include=list(files.values()), config_file=False)
    coverage.start()
    measuring = plugin(coverage.switch_context, SHARED)
    coverage.switch_context(SHARED)
    started = time.process_time()
    by = _pytest(plan, part.tests, measuring)
    whole = time.process_time() - started
    coverage.stop()
    if by:
        return {"by": by}
    data = coverage.get_data()
    lines = {
        module: {line: tuple(sorted(names)) for line, names in data.contexts_by_lineno(file).items()}
        for module, file in files.items()
    }
    loaded = tuple(name for name, found in sys.modules.items() if _is_library(plan, name, found))
    seconds = {**measuring.seconds, SHARED: whole - sum(measuring.seconds.values())}
    return Baseline(seconds, lines, loaded).document()


def _is_library(plan: Plan, name: str, found: ModuleType) -> bool:
    """Whether a module can be had before the tests are collected: it is installed, or of the packages."""
    file = Path(getattr(found, "__file__", None) or os.devnull)
    own = file.is_relative_to(plan.root) and "site-packages" not in file.parts
    return name.split(".")[0] in plan.packages or (not own and name != "__main__")


def _pytest(plan: Plan, files: Sequence[str], plugin: Trial | Measuring) -> str:
    """Run pytest in this process: the test that failed, or what went wrong; empty if all passed."""
    import pytest

    options = ["-x", "-q", "--tb=no", "--assert=plain", "-p", "no:cacheprovider", "-p", "no:benchmark"]
    folder = ["--rootdir", str(plan.root), "--override-ini", "addopts=--import-mode=importlib"]
    status = pytest.main([*folder, *options, *files], plugins=[plugin])
    if status in (pytest.ExitCode.OK, pytest.ExitCode.NO_TESTS_COLLECTED):
        return ""
    return plugin.failed or f"pytest, {pytest.ExitCode(status).name.lower().replace('_', ' ')}"


class Withheld(importlib.abc.MetaPathFinder):
    """Lets nobody import a module."""

    def __init__(self, name: str) -> None:
        self.name = name

    def find_spec(
        self, fullname: str, path: Sequence[str] | None, target: ModuleType | None = None
    ) -> importlib.machinery.ModuleSpec | None:
        """No way to it."""
        if fullname == self.name:
            raise ModuleNotFoundError(f"{fullname} is withheld until it is changed", name=fullname)
        return None


class ChangedModule(importlib.abc.MetaPathFinder, importlib.abc.Loader):
    """Finds one module, and takes its code from a text."""

    def __init__(self, name: str, file: Path, source: str) -> None:
        self.name, self.file, self.source = name, file, source

    def find_spec(
        self, fullname: str, path: Sequence[str] | None, target: ModuleType | None = None
    ) -> importlib.machinery.ModuleSpec | None:
        """Its own."""
        if fullname != self.name:
            return None
        return importlib.util.spec_from_file_location(fullname, self.file, loader=self)

    def exec_module(self, module: ModuleType) -> None:
        """Run the changed source."""
        exec(compile(self.source, str(self.file), "exec"), module.__dict__)
