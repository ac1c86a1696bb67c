"""Rates by finite differences of numbers that disagree themselves, where nothing else explains the rates."""

from __future__ import annotations

from validate.diagnosis.kinds.differences import Differences


class OfWrong(Differences):
    """The same rules."""

    name, last = "differences of wrong numbers", True
    of_wrong = True


KIND = OfWrong()
