"""What every part of a scene does: it is checked however it is made, and tells its faults by key.

A part is a class of keys. Each key has a check, which reads a value as plain data or notes what is wrong with
it; then a part may check what its keys make together. All faults of a scene are found before one is told.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from typing import Any, NoReturn, Self, dataclass_transform

from pointcoord.errors import SceneError
from pointcoord.wording import meant, nearest, shown, shown_key

Place = tuple[int | str, ...]

# Faults that are told in one message beside the first; more are counted.
TOLD = 5


class Faults(list[tuple[Place, str, str]]):
    """What is wrong: the place in the scene, the problem with the value, and what is allowed there."""

    def note(self, place: Place, problem: str, value: object = ..., allowed: str = "") -> Wrong:
        """Note one; its value is shown unless it is a table."""
        told = value is not ... and not isinstance(value, dict | Part)
        self.append((place, f"{problem}, not {shown(value)}" if told else problem, allowed))
        return WRONG


class Wrong:
    """What a check gives for a value that is not as it must be."""


WRONG = Wrong()
Check = Callable[[object, Place, Faults], Any]
"""From a value and its place to the value that is kept, or to `WRONG` with a fault noted."""
Agreement = Callable[[Any, Mapping[str, Any]], Any]
"""From a value and the keys before it to the value that is kept; raises ValueError with what is wrong."""


class Key:
    """A key of a part: its check, its value where it is not given, and what it must agree with."""

    def __init__(self, check: Check, default: object, agrees: Agreement | None) -> None:
        self.check, self.default, self.agrees = check, default, agrees

    def read(self, value: object, place: Place, faults: Faults, others: Mapping[str, Any]) -> Any:
        """The value that is kept, or `WRONG`."""
        kept = self.check(value, place, faults)
        if kept is not WRONG and self.agrees is not None:
            try:
                return self.agrees(kept, others)
            except ValueError as error:
                return _noted(error, place, faults)
        return kept


def key(check: Check, *, default: Any = ..., agrees: Agreement | None = None) -> Any:
    """Declare a key of a part; it must be given unless it has a default."""
    return Key(check, default, agrees)


@dataclass_transform(kw_only_default=True, frozen_default=True, field_specifiers=(key,))
class Part:
    """A part of a scene, frozen, and checked in whatever way it is made."""

    _keys: Mapping[str, Key] = {}
    _given: frozenset[str]
    _written: Mapping[str, dict[str, Any]]

    def __init_subclass__(cls) -> None:
        keys = {name: value for name, value in vars(cls).items() if isinstance(value, Key)}
        cls._keys = {**cls._keys, **keys}
        for name in keys:
            delattr(cls, name)

    def __init__(self, **values: Any) -> None:
        made = type(self).checked(values, f"a new {type(self).__name__}")
        self.__dict__.update(made.__dict__)

    @classmethod
    def checked(cls, content: object, source: str) -> Self:
        """The part as plain data or as an object, checked.

        Raises:
            SceneError: the first fault, with its key; some further ones are told, and the others counted.
        """
        if type(content) is cls and content.unchanged:
            return content
        faults = Faults()
        part = cls.read_from(content, (), faults)
        if isinstance(part, cls):
            return part
        place, problem, allowed = faults[0]
        raise SceneError(source, _dotted(place), problem + _further(faults[1:]), allowed)

    @classmethod
    def read_from(cls, content: object, place: Place, faults: Faults) -> Any:
        """The part, or `WRONG` with its faults noted."""
        # Objects are checked again wherever they are put: their dictionaries can be written, for one.
        if isinstance(content, cls):
            content = content._as_given()
        if not isinstance(content, Mapping):
            return faults.note(
                place, "Input should be a table, such as { constant = 0.0 } for an input", content
            )
        before = len(faults)
        values: dict[str, Any] = {}
        unknown = [name for name in content if isinstance(name, str) and name not in cls._keys]
        free = [name for name in cls._keys if name not in content]
        # A key that is missing because it is misspelt is one fault.
        misspelt = {nearest(name, free) for name in unknown}
        for name, own in cls._keys.items():
            if name in content:
                value = own.read(content[name], (*place, name), faults, values)
            elif own.default is ... and name in misspelt:
                value = WRONG
            elif own.default is ...:
                value = faults.note((*place, name), "this key is missing")
            else:
                value = own.default
            if value is not WRONG:
                values[name] = value
        for name in content:
            if not isinstance(name, str):
                faults.note((*place, shown(name)), "Keys should be strings", name)
            elif name not in cls._keys:
                problem = f"there is no such key{meant(name, free)}"
                faults.note((*place, name), problem, allowed=", ".join(cls._keys))
        if len(faults) > before:
            return WRONG
        part = object.__new__(cls)
        tables = {name: dict(value) for name, value in values.items() if isinstance(value, dict)}
        part.__dict__.update(values, _given=frozenset(content), _written=tables)
        try:
            part.agree()
        except ValueError as error:
            return _noted(error, place, faults)
        return part

    @property
    def unchanged(self) -> bool:
        """Whether it is as it was when it was checked: its dictionaries can be written afterwards."""
        kept = self.__dict__
        inner = [kept[name] for name in self._keys if isinstance(kept[name], Part)]
        inner += [each for name in self._written for each in kept[name].values() if isinstance(each, Part)]
        same = all(kept[name] == table for name, table in self._written.items())
        return same and all(part.unchanged for part in inner)

    def agree(self) -> None:
        """Check what the keys make together.

        Raises:
            ValueError: what is wrong.
        """

    @property
    def model_fields_set(self) -> frozenset[str]:
        """The keys that were given."""
        return self._given

    def _as_given(self) -> dict[str, Any]:
        return {name: self.__dict__[name] for name in self._keys if name in self._given}

    def model_copy(self, *, update: Mapping[str, Any] | None = None, deep: bool = False) -> Self:
        """A copy with other values, which are checked.

        Raises:
            SceneError: a value is not allowed, or there is no such key.
        """
        import copy

        if update:
            changed = {**self._as_given(), **update}
            return type(self).checked(
                copy.deepcopy(changed) if deep else changed, f"a changed {type(self).__name__}"
            )
        return copy.deepcopy(self) if deep else copy.copy(self)

    @classmethod
    def model_construct(cls, **values: Any) -> Self:
        """The part from its values, which are checked.

        Raises:
            SceneError: a value is not allowed, or there is no such key.
        """
        return cls.checked(values, f"a new {cls.__name__}")

    def model_dump(
        self, *, mode: str = "python", exclude_none: bool = False, exclude: Collection[str] = ()
    ) -> dict[str, Any]:
        """The part as plain data.

        Args:
            mode: `json` makes lists of what is a tuple otherwise.
            exclude_none: leave out keys that are None.
            exclude: keys of this part to leave out.
        """
        return {
            name: _plain(self.__dict__[name], mode, exclude_none)
            for name in self._keys
            if name not in exclude and not (exclude_none and self.__dict__[name] is None)
        }

    def model_dump_json(self) -> str:
        """The part as JSON."""
        import json

        return json.dumps(self.model_dump(mode="json"), separators=(",", ":"))

    def __eq__(self, other: object) -> bool:
        if type(other) is not type(self):
            return NotImplemented
        return all(self.__dict__[name] == other.__dict__[name] for name in self._keys)

    def __hash__(self) -> int:
        return hash((type(self), *(self.__dict__[name] for name in self._keys)))

    def __repr__(self) -> str:
        values = ", ".join(f"{name}={self.__dict__[name]!r}" for name in self._keys)
        return f"{type(self).__name__}({values})"

    def __setattr__(self, name: str, value: object) -> NoReturn:
        raise AttributeError(f"a {type(self).__name__} does not change; make another one with model_copy")

    def __delattr__(self, name: str) -> NoReturn:
        raise AttributeError(f"a {type(self).__name__} does not change; make another one with model_copy")


def _noted(error: ValueError, place: Place, faults: Faults) -> Wrong:
    """What does not agree, at the place that the error says, if it says one."""
    inner, allowed = getattr(error, "place", ()), getattr(error, "allowed", "")
    return faults.note((*place, *inner), str(error), allowed=allowed)


def _dotted(place: Place) -> str:
    return ".".join(map(shown_key, place))


def _further(faults: list[tuple[Place, str, str]]) -> str:
    """Faults beside the first, in words that follow it."""
    if not faults:
        return ""
    told = [f"{_dotted(place)}: {problem}" for place, problem, _ in faults[:TOLD]]
    if len(faults) > TOLD:
        told.append(f"{len(faults) - TOLD} others")
    return f" (and {len(faults)} more: {'; '.join(told)})"


def _plain(value: object, mode: str, exclude_none: bool) -> Any:
    if isinstance(value, Part):
        return value.model_dump(mode=mode, exclude_none=exclude_none)
    if isinstance(value, dict):
        return {name: _plain(each, mode, exclude_none) for name, each in value.items()}
    if isinstance(value, tuple):
        each = [_plain(item, mode, exclude_none) for item in value]
        return each if mode == "json" else tuple(each)
    return value
