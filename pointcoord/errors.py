"""The errors of pointcoord: one family, each with the data behind its message.

Every message says what is wrong, where, the value, what is allowed and what to try.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping
from typing import Any

# No name of ours is longer, and few folders and files are.
LONGEST = 60
MARKS = "'\":;,)]"
_LONGER = re.compile(rf"[^\s/]{{{LONGEST + 1},}}")


def visible(text: str) -> str:
    r"""The text with each character that does not print as its escape, such as \x1b, \n or \u202e.

    These are the controls, the marks that turn the direction of writing, the separators but for the space,
    and halves of characters, which file names may hold. What prints stays as it is, but of a word, or a part
    of a path, that is longer than LONGEST only the beginning is there.
    """
    escaped = "".join(c if c.isprintable() else c.encode("unicode_escape").decode("ascii") for c in text)
    return _LONGER.sub(_beginning, escaped)


def _beginning(found: re.Match[str]) -> str:
    word = found[0].rstrip(MARKS)
    marks = found[0][len(word) :]
    return (word if len(word) <= LONGEST else word[: LONGEST - 3] + "...") + marks[:3]


class PointcoordError(Exception):
    """Base of every error that pointcoord raises on purpose.

    Its message is one line of characters that print, whatever a scene or a file is called. It can be
    pickled, with its data, so that it comes back from another process.

    Attributes:
        partial: the `Motion` up to where it stopped, with at least one instant; None if nothing was solved.
    """

    partial: Any = None

    def __init__(self, message: str) -> None:
        super().__init__(visible(message))

    def __reduce__(
        self,
    ) -> tuple[Callable[..., PointcoordError], tuple[type[PointcoordError], str, Mapping[str, object]]]:
        return _again, (type(self), str(self), self.__dict__)


def _again(kind: type[PointcoordError], message: str, data: Mapping[str, object]) -> PointcoordError:
    """An error with a message and data at hand; its own `__init__` makes the one from the other."""
    error = kind.__new__(kind, message)
    error.__dict__.update(data)
    return error


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
        # Imported here: few names are misspelt.
        from difflib import get_close_matches

        near = get_close_matches(name, self.valid, n=1)
        hint = f" (did you mean {near[0]!r}?)" if near else ""
        super().__init__(f"no {kind} named {name!r}{hint}; there are: {', '.join(self.valid) or 'none'}")


class NotComputed(PointcoordError, LookupError):
    """A result that the scene, or the method of its solution, does not give.

    Args:
        quantity: what is asked for.
        effect: the effect that gives it; empty if a method does.
        advice: what to try; adds the effect to the scene unless given.
    """

    def __init__(self, quantity: str, effect: str, advice: str = "") -> None:
        self.quantity = quantity
        self.effect = effect
        self.advice = advice or f"add {effect!r} to the scene's effects"
        super().__init__(f"{quantity} was not computed; {self.advice}")


class MissingLibrary(PointcoordError, ImportError):
    """Something needs an optional library that is not installed, or that does not load.

    Args:
        part: what needs it.
        libraries: any of which would do; each is an extra of the same name.
        problem: what is wrong with them, if they are there.
    """

    def __init__(self, part: str, libraries: Iterable[str], problem: str = "is not installed") -> None:
        self.part = part
        self.libraries = tuple(libraries)
        extras = " or ".join(f"pip install 'pointcoord[{name}]'" for name in self.libraries)
        super().__init__(f"{part} needs {' or '.join(self.libraries)}, which {problem}; try: {extras}")


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


class InputNotKnown(PointcoordError):
    """The terms of an input's law cancel so far that what is left is not known well enough.

    Args:
        name: the input. law: its kind. value: of the input as summed, rad or mm.
        doubt: how far the value may be off, rad or mm. instant: s.
    """

    def __init__(self, name: str, law: str, value: float, doubt: float, instant: float) -> None:
        self.name = name
        self.law = law
        self.value = value
        self.doubt = doubt
        self.instant = instant
        super().__init__(
            f"input {name!r} is not known at t = {instant:.10g} s: the terms of its {law} cancel to "
            f"{value:.3g}, which may be off by {doubt:.2g}, and no pose can be proven from that; give a law "
            "of smaller terms, such as a table of values, or the same motion in a time that starts near zero"
        )


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
    ) -> None:
        self.problem = problem
        self.reached = reached
        self.wanted = wanted
        self.condition = condition
        self.reduce = reduce
        self.limits = limits
        self.instant = instant
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

    Attributes:
        expected: about how many the whole motion takes.
    """

    def __init__(self, limit: int, instant: float, start: float, stop: float) -> None:
        self.limit = limit
        self.instant = instant
        self.start = start
        self.stop = stop
        self.expected = limit * (stop - start) / (instant - start)
        super().__init__(
            f"the motion from {start:.6g} to {stop:.6g} s takes about {self.expected:.2g} segments; allowed: "
            f"{limit}, which reach t = {instant:.6g} s; shorten the time, slow the inputs down, or use the "
            "method 'newton', which solves at the scene's instants only"
        )


class MotionTooRough(PointcoordError):
    """An input that changes too fast, or from too large terms, for any step of a series to follow.

    Args:
        name: the input. instant: how far the motion came, s.
        coarsest: whether no larger tolerance is left to try.
    """

    def __init__(self, name: str, instant: float, *, coarsest: bool = False) -> None:
        self.name = name
        self.instant = instant
        looser = "" if coarsest else "allow a larger tolerance, "
        super().__init__(
            f"input {name!r} changes too fast or too unevenly after t = {instant:.10g} s: no step that time "
            "can tell apart follows it to the tolerance, though the mechanism could; smooth it there, "
            f"{looser}or use the method 'newton', which solves at the scene's instants only"
        )


class MotionNotMapped(PointcoordError):
    """A motion whose inputs go where no map of them is proven.

    Args:
        instant: up to when the way of the inputs is covered, s; the start if nothing is.
        inputs: value of each input there.
        reason: why not further.
    """

    def __init__(self, instant: float, inputs: Mapping[str, float], reason: str) -> None:
        self.instant = instant
        self.inputs = dict(inputs)
        self.reason = reason
        place = ", ".join(f"{name} = {value:.10g}" for name, value in inputs.items())
        super().__init__(
            f"the map of the inputs does not cover their way after t = {instant:.10g} s, {place}: {reason}; "
            "keep the inputs farther from there, or use the method 'series' or 'newton'"
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


class WrongArgument(PointcoordError, ValueError):
    """A kinematic map or a sweep cannot be made, used or read as it was asked for.

    Args:
        what: the argument, option, file or design at fault.
        problem: what is wrong, with the value.
        allowed: what would be right.
    """

    def __init__(self, what: str, problem: str, allowed: str) -> None:
        self.what = what
        self.problem = problem
        self.allowed = allowed
        super().__init__(f"{what} {problem}; allowed: {allowed}")


MapError = SweepError = WrongArgument


class NotCovered(PointcoordError, ValueError):
    """Inputs inside the range of a kinematic map at which nothing is proven.

    Args:
        inputs: value of each input, the first that is not covered.
        reason: why not.
        count: how many of those that were asked for are not. asked: how many there are.
    """

    def __init__(self, inputs: Mapping[str, float], reason: str, count: int, asked: int) -> None:
        self.inputs = dict(inputs)
        self.reason = reason
        self.count = count
        self.asked = asked
        place = ", ".join(f"{name} = {value:.10g}" for name, value in inputs.items())
        others = f"; {count} of {asked} poses are not covered" if asked > 1 else ""
        super().__init__(
            f"the map does not cover {place}: {reason}{others}; keep to what `covers` says, or make the map "
            "of a smaller range or with more halvings"
        )
