"""Plugins of pytest for the trials of mutants: which test fails first, and which tests run which lines."""

from __future__ import annotations

import contextlib
import time
from collections.abc import Callable, Generator, Sequence

import pytest


class Watching:
    """Remembers the first failure; searches for examples end with the first that fails."""

    failed = ""

    def pytest_collection(self) -> None:
        """Before test files are read: their settings begin with those that hold now."""
        with contextlib.suppress(ImportError):
            from hypothesis import Phase, settings

            settings.register_profile("mutants", settings(phases=(Phase.explicit, Phase.generate)))
            settings.load_profile("mutants")

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        """A test, or a fixture before or after it, failed."""
        if report.failed and not self.failed:
            self.failed = report.nodeid

    def pytest_collectreport(self, report: pytest.CollectReport) -> None:
        """A file of tests could not be read."""
        if report.failed and not self.failed:
            self.failed = f"import of {report.nodeid or 'the tests'}"


class Trial(Watching):
    """Runs some tests only, in their order."""

    def __init__(self, tests: Sequence[str]) -> None:
        self.order = {test: i for i, test in enumerate(tests)}

    @pytest.hookimpl(trylast=True)
    def pytest_collection_modifyitems(self, items: list[pytest.Item]) -> None:
        """Leave the others out."""
        wanted = [item for item in items if item.nodeid in self.order]
        items[:] = sorted(wanted, key=lambda item: self.order[item.nodeid])


class Measuring(Watching):
    """Measures the processor time of each test, and tells which one runs now, or that it is for several."""

    def __init__(self, runs: Callable[[str], object], shared: str) -> None:
        self.runs, self.shared, self.seconds = runs, shared, dict[str, float]()
        self.now = shared

    def _turn_to(self, name: str) -> str:
        before, self.now = self.now, name
        self.runs(name)
        return before

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_protocol(self, item: pytest.Item) -> Generator[None, object, object]:
        """A test with its own fixtures."""
        began = time.process_time()
        before = self._turn_to(item.nodeid)
        try:
            return (yield)
        finally:
            self._turn_to(before)
            self.seconds[item.nodeid] = time.process_time() - began

    @pytest.hookimpl(wrapper=True)
    def pytest_fixture_setup(self, fixturedef: pytest.FixtureDef[object]) -> Generator[None, object, object]:
        """What is made for more than one test is everybody's."""
        if fixturedef.scope == "function":
            return (yield)
        before = self._turn_to(self.shared)
        try:
            return (yield)
        finally:
            self._turn_to(before)
