"""Frozen data classes that cost little to define.

The standard library writes and compiles six functions for each class; for a package of seventy that takes
half as long as importing numpy. Here one function, `__init__`, is compiled, when a class is first used; the
others are the same for all classes and go through the fields. What a class does is the same, and so is what
`dataclasses.fields`, `replace` and `is_dataclass` make of it; a checker of types sees the standard ones.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from dataclasses import dataclass as dataclass
else:
    from dataclasses import MISSING, Field, FrozenInstanceError, field
    from dataclasses import dataclass as standard
    from inspect import get_annotations
    from operator import attrgetter

    @standard(frozen=True)
    class Sample:
        """A class of the standard library's: what marks its field and itself marks all of them."""

        value: int

    PARAMETERS, MARK = Sample.__dataclass_params__, Sample.__dataclass_fields__["value"]._field_type

    def dataclass(*, frozen: bool, repr: bool = True, eq: bool = True):
        """A frozen data class of the annotated attributes of a class and of those that it is made from."""
        if not frozen:
            raise TypeError("a data class that can change: take the standard library's")

        def made(cls):
            fields = {}
            for base in reversed(cls.__mro__[1:]):
                fields.update(vars(base).get("__dataclass_fields__", {}))
            for name, annotation in get_annotations(cls).items():
                fields[name] = _own_field(cls, name, annotation)
            cls.__dataclass_fields__, cls.__dataclass_params__ = fields, PARAMETERS
            cls.__match_args__ = tuple(fields)
            cls.__setattr__, cls.__delattr__ = _refuse_to_set, _refuse_to_delete
            made_here = {"__init__": _on_first_use(cls, fields)}
            if eq:
                made_here["__eq__"], made_here["__hash__"] = _compared(tuple(fields))
            if repr:
                made_here["__repr__"] = _shown
            for name, function in made_here.items():
                # What a class says itself stays; Python gives one that says `__eq__` alone a hash of None.
                if vars(cls).get(name) is None:
                    setattr(cls, name, function)
            return cls

        return made

    def _own_field(cls, name: str, annotation: object) -> Field:
        given = vars(cls).get(name, MISSING)
        own = given if isinstance(given, Field) else field(default=given)
        own.name, own.type, own._field_type, own.kw_only = name, annotation, MARK, False
        if own.default is not MISSING:
            setattr(cls, name, own.default)
        elif given is not MISSING:
            delattr(cls, name)
        return own

    def _on_first_use(cls, fields: dict[str, Field]):
        def first_use(self, *args, **kwargs) -> None:
            cls.__init__ = _compiled(cls, fields)
            cls.__init__(self, *args, **kwargs)

        return first_use

    def _compiled(cls, fields: dict[str, Field]):
        """The function that takes the fields as arguments and sets them."""
        # No field can have the name that the fields are set by.
        names, arguments, lines = {"MISSING": MISSING}, ["self"], ["__fields__ = self.__dict__"]
        for name, own in fields.items():
            value = name
            if own.default_factory is not MISSING:
                names[f"_make_{name}"] = own.default_factory
                value = f"_make_{name}() if {name} is MISSING else {name}"
                arguments.append(f"{name}=MISSING")
            elif own.default is not MISSING:
                names[f"_default_{name}"] = own.default
                arguments.append(f"{name}=_default_{name}")
            else:
                arguments.append(name)
            lines.append(f"__fields__[{name!r}] = {value}")
        if hasattr(cls, "__post_init__"):
            lines.append("self.__post_init__()")
        exec(f"def __init__({', '.join(arguments)}):\n " + "\n ".join(lines), names)
        names["__init__"].__qualname__ = f"{cls.__qualname__}.__init__"
        return names["__init__"]

    def _compared(names: tuple[str, ...]):
        """How two are found equal, and hashed: by all their fields."""
        values = attrgetter(*names) if names else lambda item: ()

        def equal(self, other: object) -> bool:
            return values(self) == values(other) if other.__class__ is self.__class__ else NotImplemented

        return equal, lambda self: hash(values(self))

    def _shown(self) -> str:
        shown = (f"{n}={getattr(self, n)!r}" for n, own in self.__dataclass_fields__.items() if own.repr)
        return f"{self.__class__.__qualname__}({', '.join(shown)})"

    def _refuse_to_set(self, name: str, value: object) -> None:
        raise FrozenInstanceError(f"cannot assign to field {name!r}")

    def _refuse_to_delete(self, name: str) -> None:
        raise FrozenInstanceError(f"cannot delete field {name!r}")
