"""The errors of pointcoord: one family, each with the data behind its message.

Every message says what is wrong, where, the value, what is allowed and what to try.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping
from typing import Any

# No built-in name is longer, and few folders and files are.
LONGEST = 60
MARKS = "'\":;,)]"
_LONGER = re.compile(rf"[^\s/]{{{LONGEST + 1},}}")


def visible(text: str) -> str:
    r"""The text with each non-printing character replaced by its escape, such as \x1b, \n or \u202e.

    Replaced are control characters, marks that turn the direction of writing, separators other than a space,
    and lone surrogates, which file names may hold. Printing characters stay, but a word, or a part of a path,
    that is longer than LONGEST is cut.
    """
    escaped = "".join(c if c.isprintable() else c.encode("unicode_escape").decode("ascii") for c in text)
    return _LONGER.sub(_beginning, escaped)


def _beginning(found: re.Match[str]) -> str:
    word = found[0].rstrip(MARKS)
    marks = found[0][len(word) :]
    return (word if len(word) <= LONGEST else word[: LONGEST - 3] + "...") + marks[:3]


class PointcoordError(Exception):
    """Base of every error that pointcoord raises on purpose.

    Its message is one line of printing characters, whatever a scene or a file is called. It can be pickled
    with its data, and so be passed between processes.

    Args:
        said: what is wrong, where, with the value.
        allowed: what would be right. advice: what to try. Both are empty where `said` includes them.

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
    """Rebuild an error from its message and data: its own `__init__` would build the message again."""
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
        reason: the kind of fault, in words without numbers.
    """

    def __init__(
        self, source: str, key: str, problem: str, allowed: str = "", reason: str = "the drawing is refused"
    ) -> None:
        self.source = source
        self.key = key
        self.problem = problem
        self.reason = reason
        super().__init__(f"{source}: {key}: {problem}" if key else f"{source}: {problem}", allowed)

    def of(self, source: str) -> SceneError:
        """This error with another name of the scene."""
        return SceneError(source, self.key, self.problem, self.allowed, self.reason)


class UnknownName(PointcoordError, LookupError):
    """An unknown name; the message lists the names that exist.

    Args:
        hint: where the name stands instead; the nearest of the names that exist unless given.
    """

    def __init__(self, kind: str, name: str, valid: Iterable[str], hint: str = "") -> None:
        self.kind = kind
        self.name = name
        self.valid = tuple(valid)
        # Imported here: few names are misspelt.
        from difflib import get_close_matches

        if near := get_close_matches(name, self.valid, n=1):
            hint = hint or f"did you mean {near[0]!r}?"
        words = f"no {kind} named {name!r} ({hint})" if hint else f"no {kind} named {name!r}"
        super().__init__(f"{words}; there are: {', '.join(self.valid) or 'none'}")


class NotComputed(PointcoordError, LookupError):
    """A result that the scene, or its method of solution, does not compute.

    Args:
        quantity: the result asked for.
        effect: the effect that computes it; empty if a method does.
        advice: what to try; "add the effect to the scene" unless given.
    """

    def __init__(self, quantity: str, effect: str, advice: str = "") -> None:
        self.quantity = quantity
        self.effect = effect
        advice = advice or f"add {effect!r} to the scene's effects"
        super().__init__(f"{quantity} was not computed", advice=advice)


class MissingLibrary(PointcoordError, ImportError):
    """An optional library is needed, and it is not installed or does not load.

    Args:
        part: the feature that needs it.
        libraries: the libraries, any one of which is enough.
        problem: what is wrong with them, if they are installed.
        extra: the extra of this distribution that installs them; named as each library unless given.
        advice: what to try instead of installing them.
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
        message = f"{part} needs the package {named}, which {problem}"
        super().__init__(message, advice=advice or f"try: {brought}")


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
    """An input value for which the equation has no solution or no unique one, or that is too uncertain.

    Args:
        name: the input. value: rad or mm. instant: s.
        doubt: uncertainty of the value, rad or mm, where the terms of the input's law cancel so far that no
            pose can be proven from the difference.
        law: kind of the law, where there is such an uncertainty.
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
        message, advice = f"input {name!r} is {value:.10g}{when}", ""
        if doubt:
            message = (
                f"input {name!r} is not known{when}: the terms of its {law} cancel to {value:.3g}, which may "
                f"be off by {doubt:.2g}, and no pose can be proven from that"
            )
            advice = (
                "give a law of smaller terms, such as a table of values, or the same motion in a time that "
                "starts near zero"
            )
        super().__init__(message, allowed, advice)


class AssemblyError(PointcoordError):
    """The mechanism cannot follow its inputs beyond a certain pose.

    Args:
        problem: what stopped it.
        reached: value of every input at the last assembled pose.
        wanted: value of every input that was asked for.
        instant: time of the wanted pose, s, if it belongs to a motion.
        condition: condition number at the last assembled pose.
        reduce: the input with the largest remaining change of its driven coordinate; empty if no input has
            any change left, so that the drawing itself does not close.
        limits: the links and joints that block each other there, the strongest first.
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
        advice = "draw the points of these closer to an assembled pose"
        if reduce:
            advice = f"bring {reduce!r} back towards its value there"
        super().__init__(
            f"{problem}{when}: wanted {_listed(wanted)}; assembly stopped at {_listed(reached)} "
            f"(condition number {condition:.2g}), limited by {', '.join(limits[:3]) or 'an unknown link'}",
            advice=advice,
        )


def _listed(inputs: Mapping[str, float]) -> str:
    return ", ".join(f"{name} = {value:.10g}" for name, value in inputs.items())


class NotFollowed(PointcoordError):
    """A motion that power series in time cannot follow: too many are needed, or none follows an input.

    Args:
        instant: time that the series reach, s.
        name: the input that changes too fast after that, or whose terms are too large, for any step; empty if
            too many series are needed.
        coarsest: whether the tolerance cannot be made larger.
        limit: largest number of series. start, stop: span of the whole motion, s.

    Attributes:
        problem: which of the two problems, without numbers.
        expected: estimated number of series for the whole motion, if these are too many; else zero.
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
            message = (
                f"input {name!r} changes too fast or too unevenly after t = {instant:.10g} s: the mechanism "
                "could follow, but the series misses the tolerance even with the shortest step in time"
            )
            advice = "smooth it there" + ("" if coarsest else ", allow a larger tolerance")
        else:
            self.problem = "the motion takes too many series"
            message = f"the motion from {start:.6g} to {stop:.6g} s takes about {self.expected:.2g} segments"
            allowed = f"{limit} segments, which reach t = {instant:.6g} s"
            advice = "shorten the time, slow the inputs down"
        newton = "or use the method 'newton', which solves at the scene's instants only"
        super().__init__(message, allowed, f"{advice}, {newton}")


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
    """A motion, a kinematic map or a sweep cannot be made, used or read as requested.

    Args:
        what: the argument, option, file, instant or design at fault.
        problem: what is wrong, with the value.
        allowed: what would be right.
        instant: time at fault, s, if there is one.
    """

    def __init__(self, what: str, problem: str, allowed: str, instant: float | None = None) -> None:
        self.what = what
        self.problem = problem
        self.instant = instant
        super().__init__(f"{what} {problem}", allowed)


class NotCovered(PointcoordError, ValueError):
    """Inputs at which nothing is proven, though they lie in the range of a map or on the path of a motion.

    Args:
        inputs: value of each input: for a kinematic map at the first pose that is not covered, for a motion
            at the last covered one.
        reason: why the cover ends.
        count: number of requested poses that are not covered. asked: number of requested poses.
        instant: for a motion by a map, the time up to which its path is covered, s; the start if no part is.
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
        advice = "use inputs that `covers` accepts, or make the map of a smaller range or with more halvings"
        if instant is not None:
            where = f"the map of the inputs does not cover their path after t = {instant:.10g} s,"
            advice = "keep the inputs farther from there, or use the method 'series' or 'newton'"
        others = f"; {count} of {asked} poses are not covered" if asked > 1 else ""
        super().__init__(f"{where} {_listed(inputs)}: {reason}{others}", advice=advice)


# Earlier names of errors that are now one class.
MapError = SweepError = OutsideMotion = WrongArgument
MotionTooLong = MotionTooRough = NotFollowed
MotionNotMapped = NotCovered
InputNotKnown = InputOutOfRange
