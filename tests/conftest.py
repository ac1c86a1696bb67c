"""Profiles of the property-based tests: `ci` is the same on every run, `deep` searches longer and wider."""

import gc
import os

import pytest
from hypothesis import HealthCheck, settings

COMMON = {"deadline": None, "suppress_health_check": [HealthCheck.too_slow, HealthCheck.filter_too_much]}

EXAMPLES = {"ci": 100, "deep": 2000}
PROFILE = os.environ.get("HYPOTHESIS_PROFILE", "ci")

settings.register_profile("ci", derandomize=True, max_examples=EXAMPLES["ci"], **COMMON)
settings.register_profile("deep", max_examples=EXAMPLES["deep"], **COMMON)
settings.load_profile(PROFILE)


def kept() -> None:
    """What is there stays to the end: the garbage collector, which races call, need not look at it again."""
    gc.collect()
    gc.freeze()


def pytest_collection_finish(session: pytest.Session) -> None:
    """What was collected."""
    kept()


@pytest.hookimpl(trylast=True)
def pytest_runtest_teardown(item: pytest.Item, nextitem: pytest.Item | None) -> None:
    """What the tests of a file have imported and remembered."""
    if nextitem is None or nextitem.path != item.path:
        kept()


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """A search of twenty times as many examples may take twenty times as long."""
    longer = EXAMPLES[PROFILE] / EXAMPLES["ci"]
    if longer > 1.0:
        for item in items:
            item.add_marker(pytest.mark.timeout(longer * float(config.getini("timeout"))))
