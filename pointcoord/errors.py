"""The errors of pointcoord: one family, each with the data behind its message.

Every message says what is wrong, where, the value, what is allowed and what to try.
"""

from __future__ import annotations

from collections.abc import Iterable
from difflib import get_close_matches


class PointcoordError(Exception):
    """Base of every error that pointcoord raises on purpose."""


class SceneError(PointcoordError):
    """A scene cannot be used as written.

    Args:
        source: file or name of the scene.
        key: the key at fault, dotted from the top of the file.
        problem: what is wrong, with the value.
        allowed: what would be right.
    """

    def __init__(self, source: str, key: str, problem: str, allowed: str = "") -> None:
        self.source = source
        self.key = key
        self.problem = problem
        self.allowed = allowed
        where = f"{source}: {key}" if key else source
        super().__init__(f"{where}: {problem}" + (f"; allowed: {allowed}" if allowed else ""))


class UnknownName(PointcoordError, LookupError):
    """A name that nothing carries; the message lists the names that exist."""

    def __init__(self, kind: str, name: str, valid: Iterable[str]) -> None:
        self.kind = kind
        self.name = name
        self.valid = tuple(valid)
        near = get_close_matches(name, self.valid, n=1)
        hint = f" (did you mean {near[0]!r}?)" if near else ""
        super().__init__(f"no {kind} named {name!r}{hint}; there are: {', '.join(self.valid) or 'none'}")


class NotComputed(PointcoordError, LookupError):
    """A result that the scene did not ask for."""

    def __init__(self, quantity: str, effect: str) -> None:
        self.quantity = quantity
        self.effect = effect
        super().__init__(f"{quantity} was not computed; add {effect!r} to the scene's effects")


class MechanismError(PointcoordError):
    """The points, links and joints do not make a mechanism with one assembly per input.

    Args:
        problem: what is wrong, and where.
        names: the free coordinates, or the rows at fault.
    """

    def __init__(self, problem: str, names: Iterable[str] = ()) -> None:
        self.problem = problem
        self.names = tuple(names)
        super().__init__(problem)


class InputOutOfRange(PointcoordError):
    """An input has a value for which its equation has no or no unique meaning."""

    def __init__(self, name: str, value: float, allowed: str, instant: float | None = None) -> None:
        self.name = name
        self.value = value
        self.allowed = allowed
        self.instant = instant
        when = "" if instant is None else f" at t = {instant:.6g} s"
        super().__init__(f"input {name!r} is {value:.10g}{when}; allowed: {allowed}")


class AssemblyError(PointcoordError):
    """The mechanism cannot follow its inputs beyond a certain place.

    Args:
        problem: what stopped it.
        reached: value of every input at the last assembled pose.
        wanted: value of every input that was asked for.
        instant: time of the wanted pose, s, if it belongs to a motion.
        condition: condition number at the last assembled pose.
        reduce: the input with the most still to go, measured as its driven coordinate; empty if none has
            any way left, so that the drawing itself does not close.
        limits: the links and joints that hold each other there, the strongest first.
        partial: the motion up to the last assembled instant, if any.
    """

    def __init__(
        self,
        problem: str,
        *,
        reached: dict[str, float],
        wanted: dict[str, float],
        condition: float,
        reduce: str,
        limits: tuple[str, ...] = (),
        instant: float | None = None,
        partial: object = None,
    ) -> None:
        self.problem = problem
        self.reached = reached
        self.wanted = wanted
        self.condition = condition
        self.reduce = reduce
        self.limits = limits
        self.instant = instant
        self.partial = partial
        when = "" if instant is None else f" at t = {instant:.6g} s"
        goals = ", ".join(f"{name} = {value:.10g}" for name, value in wanted.items())
        stops = ", ".join(f"{name} = {value:.10g}" for name, value in reached.items())
        advice = (
            f"bring {reduce!r} back towards its value there" if reduce else "draw these nearer to closing"
        )
        super().__init__(
            f"{problem}{when}: wanted {goals}; assembly stopped at {stops} "
            f"(condition number {condition:.2g}), limited by {', '.join(limits[:3]) or 'an unknown link'}; "
            f"{advice}"
        )


class MotionTooLong(PointcoordError):
    """A motion that would take more segments than the limit.

    Args:
        limit: most segments. instant: how far they reached, s. start, stop: of the motion, s.
        partial: the motion up to the instant.
    """

    def __init__(self, limit: int, instant: float, start: float, stop: float, partial: object) -> None:
        self.limit = limit
        self.instant = instant
        self.start = start
        self.stop = stop
        self.partial = partial
        expected = limit * (stop - start) / (instant - start)
        super().__init__(
            f"the motion from {start:.6g} to {stop:.6g} s takes about {expected:.2g} segments; allowed: "
            f"{limit}, which reach t = {instant:.6g} s; shorten the time, slow the inputs down, or use the "
            "method 'newton', which solves at the scene's instants only"
        )


class MotionTooRough(PointcoordError):
    """An input that changes too fast, or from too large terms, for any step of a series to follow.

    Args:
        name: the input. instant: how far the motion came, s.
        partial: the motion up to the instant, if any.
    """

    def __init__(self, name: str, instant: float, partial: object) -> None:
        self.name = name
        self.instant = instant
        self.partial = partial
        super().__init__(
            f"input {name!r} changes too fast or too unevenly after t = {instant:.10g} s: no step that time "
            "can tell apart follows it to the tolerance, though the mechanism could; smooth it there, allow "
            "a larger tolerance, or use the method 'newton', which solves at the scene's instants only"
        )


class SingularConfiguration(PointcoordError):
    """The equations lose rank at a pose: a direction is free and the rates are not determined."""

    def __init__(self, free: str, condition: float, where: str = "") -> None:
        self.free = free
        self.condition = condition
        self.where = where
        super().__init__(
            f"singular configuration{' ' + where if where else ''}: {free} "
            f"(condition number {condition:.2g}); move an input or a point away from it"
        )


class OutsideMotion(PointcoordError, ValueError):
    """An instant outside the time that a motion covers."""

    def __init__(self, instant: float, start: float, stop: float) -> None:
        self.instant = instant
        self.start = start
        self.stop = stop
        super().__init__(
            f"t = {instant:.10g} s is outside the motion; allowed: {start:.10g} to {stop:.10g} s"
        )
