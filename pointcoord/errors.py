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

    Args:
        said: what is wrong, where, with the value.
        allowed: what would be right. advice: what to try. Empty where what is said tells it.

    Attributes:
        partial: the `Motion` up to where it stopped, with at least one instant; None if nothing was solved.
    """

    partial: Any = None

    def __init__(self, said: str, allowed: str = "", advice: str = "") -> None:
        self.allowed = allowed
        self.advice = advice
        parts = (said, f"allowed: {allowed}" if allowed else "", advice)
        super().__init__(visible("; ".join(part for part in parts if part)))

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
        super().__init__(f"{source}: {key}: {problem}" if key else f"{source}: {problem}", allowed)


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
        advice = advice or f"add {effect!r} to the scene's effects"
        super().__init__(f"{quantity} was not computed", advice=advice)


class MissingLibrary(PointcoordError, ImportError):
    """Something needs an optional library that is not installed, or that does not load.

    Args:
        part: what needs it.
        libraries: any of which would do.
        problem: what is wrong with them, if they are there.
        extra: of this distribution, that brings them; one of the same name for each unless given.
        advice: what to try, if not to install them.
    """

    def __init__(
        self,
        part: str,
        libraries: Iterable[str],
        problem: str = "is not installed",
        extra: str = "",
        advice: str = "",
    ) -> None:
        self.part = part
        self.libraries = tuple(libraries)
        extras = (extra,) if extra else self.libraries
        brought = " or ".join(f"pip install 'pointcoord[{name}]'" for name in extras)
        named = " or ".join(map(repr, self.libraries))
        said = f"{part} needs the package {named}, which {problem}"
        super().__init__(said, advice=advice or f"try: {brought}")


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
    """An input has a value for which its equation has no or no unique meaning, or that is hardly known.

    Args:
        name: the input. value: rad or mm. instant: s.
        doubt: how far the value may be off, rad or mm, where the terms of the law cancel so far that no pose
            can be proven from what is left.
        law: its kind, where there is such a doubt.
    """

    def __init__(
        self,
        name: str,
        value: float,
        allowed: str,
        instant: float | None = None,
        *,
        doubt: float = 0.0,
        law: str = "",
    ) -> None:
        self.name = name
        self.value = value
        self.instant = instant
        self.doubt = doubt
        self.law = law
        when = "" if instant is None else f" at t = {instant:.10g} s"
        said, advice = f"input {name!r} is {value:.10g}{when}", ""
        if doubt:
            said = (
                f"input {name!r} is not known{when}: the terms of its {law} cancel to {value:.3g}, which may "
                f"be off by {doubt:.2g}, and no pose can be proven from that"
            )
            advice = (
                "give a law of smaller terms, such as a table of values, or the same motion in a time that "
                "starts near zero"
            )
        super().__init__(said, allowed, advice)


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
        advice = "draw these nearer to closing"
        if reduce:
            advice = f"bring {reduce!r} back towards its value there"
        super().__init__(
            f"{problem}{when}: wanted {_told(wanted)}; assembly stopped at {_told(reached)} "
            f"(condition number {condition:.2g}), limited by {', '.join(limits[:3]) or 'an unknown link'}",
            advice=advice,
        )


def _told(inputs: Mapping[str, float]) -> str:
    return ", ".join(f"{name} = {value:.10g}" for name, value in inputs.items())


class NotFollowed(PointcoordError):
    """A motion that power series in time do not follow: they would be too many, or none follows an input.

    Args:
        instant: how far the series reach, s.
        name: the input that changes too fast, or from too large terms, for any step after that; empty if the
            series are too many.
        coarsest: whether no larger tolerance is left to try.
        limit: most series. start, stop: of the motion that needs more, s.

    Attributes:
        problem: which of the two, without numbers.
        expected: about how many the whole motion takes, if that is too many.
    """

    def __init__(
        self,
        instant: float,
        *,
        name: str = "",
        coarsest: bool = False,
        limit: int = 0,
        start: float = 0.0,
        stop: float = 0.0,
    ) -> None:
        self.instant, self.name = instant, name
        self.limit, self.start, self.stop = limit, start, stop
        self.expected = 0.0 if name else limit * (stop - start) / (instant - start)
        if name:
            self.problem, allowed = "no series follows an input", ""
            said = (
                f"input {name!r} changes too fast or too unevenly after t = {instant:.10g} s: no step that "
                "time can tell apart follows it to the tolerance, though the mechanism could"
            )
            advice = "smooth it there" + ("" if coarsest else ", allow a larger tolerance")
        else:
            self.problem = "the motion takes too many series"
            said = f"the motion from {start:.6g} to {stop:.6g} s takes about {self.expected:.2g} segments"
            allowed = f"{limit} segments, which reach t = {instant:.6g} s"
            advice = "shorten the time, slow the inputs down"
        newton = "or use the method 'newton', which solves at the scene's instants only"
        super().__init__(said, allowed, f"{advice}, {newton}")


class SingularConfiguration(PointcoordError):
    """The equations lose rank at a pose: a direction is free and the rates are not determined."""

    def __init__(self, free: str, condition: float, where: str = "") -> None:
        self.free = free
        self.condition = condition
        self.where = where
        place = f"singular configuration {where}" if where else "singular configuration"
        advice = "move an input or a point away from it"
        super().__init__(f"{place}: {free} (condition number {condition:.2g})", advice=advice)


class WrongArgument(PointcoordError, ValueError):
    """A motion, a kinematic map or a sweep cannot be made, used or read as it was asked for.

    Args:
        what: the argument, option, file, instant or design at fault.
        problem: what is wrong, with the value.
        allowed: what would be right.
        instant: s, if one is at fault.
    """

    def __init__(self, what: str, problem: str, allowed: str, instant: float | None = None) -> None:
        self.what = what
        self.problem = problem
        self.instant = instant
        super().__init__(f"{what} {problem}", allowed)


class NotCovered(PointcoordError, ValueError):
    """Inputs at which nothing is proven, though they lie in the range of a map, or on the way of a motion.

    Args:
        inputs: value of each input: of a kinematic map the first that is not covered, of a motion the last
            that are.
        reason: why not, or not further.
        count: how many of the poses that were asked for are not. asked: how many there are.
        instant: of a motion by a map, up to when its way is covered, s; the start if nothing of it is.
    """

    def __init__(
        self,
        inputs: Mapping[str, float],
        reason: str,
        count: int = 1,
        asked: int = 1,
        instant: float | None = None,
    ) -> None:
        self.inputs = dict(inputs)
        self.reason = reason
        self.count = count
        self.asked = asked
        self.instant = instant
        where = "the map does not cover"
        advice = "keep to what `covers` says, or make the map of a smaller range or with more halvings"
        if instant is not None:
            where = f"the map of the inputs does not cover their way after t = {instant:.10g} s,"
            advice = "keep the inputs farther from there, or use the method 'series' or 'newton'"
        others = f"; {count} of {asked} poses are not covered" if asked > 1 else ""
        super().__init__(f"{where} {_told(inputs)}: {reason}{others}", advice=advice)


# Names that errors had before they became one.
MapError = SweepError = OutsideMotion = WrongArgument
MotionTooLong = MotionTooRough = NotFollowed
MotionNotMapped = NotCovered
InputNotKnown = InputOutOfRange
