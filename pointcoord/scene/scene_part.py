"""Base of every part of a scene: a frozen pydantic model, whose errors become one line that names the key.

The models state which values are allowed, and pydantic checks them. A validator raises ValueError with what
does not agree, or TableFault to name the place of the fault as well.
"""

from __future__ import annotations

import copy
from collections.abc import Mapping
from contextlib import suppress
from numbers import Real
from typing import Annotated, Any, ClassVar, Self

import numpy as np
from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    ModelWrapValidatorHandler,
    PrivateAttr,
    ValidationError,
    model_validator,
)

from pointcoord.mechanism.faults import fault_of, known_keys
from pointcoord.scene.reading import in_mm, per_mm


def _own_number(value: object) -> object:
    """A number of numpy or a fraction as a Python float; other values are left to pydantic."""
    if isinstance(value, Real) and not isinstance(value, int):
        with suppress(OverflowError):
            return float(value)
    return value


def _not_zero(value: float) -> float:
    if value == 0.0:
        raise ValueError("is 0; allowed: a number that is not 0")
    return value


IN_MM = AfterValidator(in_mm)
AS_LIST = BeforeValidator(lambda value: value.tolist() if hasattr(value, "tolist") else value)
Text = Annotated[str, Field(strict=True)]
Number = Annotated[float, Field(strict=True, allow_inf_nan=False), BeforeValidator(_own_number)]
Positive = Annotated[Number, Field(gt=0.0)]
Share = Annotated[Number, Field(ge=0.0, le=1.0)]
Length = Annotated[Number, IN_MM]
Size = Annotated[Positive, IN_MM]
PerTurn = Annotated[Number, AfterValidator(_not_zero), IN_MM]
SpringRate = Annotated[Positive, AfterValidator(per_mm)]
Whole = Annotated[
    int,
    Field(strict=True),
    BeforeValidator(lambda value: int(value) if isinstance(value, np.integer) else value),
]
Vector = Annotated[tuple[Number, Number, Number], AS_LIST]
Place = Annotated[tuple[Length, Length, Length], AS_LIST]


class Part(BaseModel):
    """A part of a scene: frozen, and checked however it is made."""

    model_config = ConfigDict(frozen=True, extra="forbid", defer_build=True)

    short_forms: ClassVar[tuple[str, ...]] = ()
    """Keys of short forms, which `completed` replaces."""

    _checked: dict[str, Any] | None = PrivateAttr(None)

    @classmethod
    def checked(cls, content: object, source: str) -> Self:
        """A checked part, from plain data or from an object.

        Raises:
            SceneError: the first fault, with its key.
        """
        try:
            return cls.model_validate(content)
        except ValidationError as error:
            raise fault_of(error).of_file(source) from None

    @classmethod
    def completed(cls, content: dict[str, Any]) -> dict[str, Any]:
        """The content of a part with its short forms written out, before it is checked."""
        return content

    @model_validator(mode="wrap")
    @classmethod
    def _in_whole(cls, content: object, by_keys: ModelWrapValidatorHandler[Self]) -> Self:
        # Dictionaries of objects may have been changed since these were checked.
        if isinstance(content, cls):
            if content.unchanged:
                return content
            content = content.as_given()
        if isinstance(content, Mapping):
            known_keys(content, (*cls.model_fields, *cls.short_forms))
            content = cls.completed(dict(content))
        part = by_keys(content).agreed()
        part._checked = part.model_dump()
        return part

    def agreed(self) -> Self:
        """The part, after a check that the values of its keys agree with each other.

        Raises:
            ValueError: what is wrong.
        """
        return self

    @property
    def unchanged(self) -> bool:
        """Whether the part is as it was when checked: its dictionaries can be changed afterwards."""
        return self._checked is not None and self._checked == self.model_dump()

    def as_given(self) -> dict[str, Any]:
        """The values that were given, by key, as plain content of an equal part."""
        return {name: value for name, value in self if name in self.model_fields_set}

    def model_copy(self, *, update: Mapping[str, Any] | None = None, deep: bool = False) -> Self:
        """A copy with changed values, which are checked.

        Raises:
            SceneError: a value is not allowed, or there is no such key.
        """
        if not update:
            return super().model_copy(deep=deep)
        changed = {**self.as_given(), **update}
        return self.checked(copy.deepcopy(changed) if deep else changed, f"a changed {type(self).__name__}")
