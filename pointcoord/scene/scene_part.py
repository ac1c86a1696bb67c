"""Base of every part of a scene: a frozen pydantic model, whose errors become one line that names the key.

The models state which values are allowed, and pydantic checks them. A validator raises ValueError with what
does not agree, or TableFault to name the place of the fault as well.
"""

from __future__ import annotations

import copy
from collections.abc import Mapping
from typing import Annotated, Any, ClassVar, Self, SupportsFloat

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

from pointcoord.mechanism.faults import faults_of, known_keys

Place = tuple[int | str, ...]


def own_number(value: object) -> object:
    """A numpy number or a fraction as a Python number; booleans and arrays are left as they are."""
    # Compares the exact type: a numpy float is an instance of `float` as well.
    if type(value) in (float, int) or isinstance(value, bool | np.ndarray | np.complexfloating):
        return value
    if isinstance(value, np.bool_):
        return bool(value)
    try:
        return float(value) if isinstance(value, SupportsFloat) else value
    except (OverflowError, TypeError, ValueError):
        return value


def _own_whole(value: object) -> object:
    return int(value) if isinstance(value, np.integer) else value


def own_list(value: object) -> object:
    """Any iterable as a tuple; text and tables are left as they are."""
    if isinstance(value, str | bytes | bytearray | Mapping) or not hasattr(value, "__iter__"):
        return value
    return tuple(value)


def _not_zero(value: float) -> float:
    if value == 0.0:
        raise ValueError("is 0; allowed: a number that is not 0")
    return value


def _own_table(value: object) -> object:
    """A table of plain data, with tuples for its lists."""
    if isinstance(value, Mapping):
        return {name: _own_table(each) for name, each in value.items()}
    return tuple(map(_own_table, value)) if isinstance(value, list | tuple) else value


AS_LIST = BeforeValidator(own_list)
Text = Annotated[str, Field(strict=True)]
Number = Annotated[float, Field(strict=True, allow_inf_nan=False), BeforeValidator(own_number)]
Positive = Annotated[Number, Field(gt=0.0)]
NotZero = Annotated[Number, AfterValidator(_not_zero)]
Share = Annotated[Number, Field(ge=0.0, le=1.0)]
Whole = Annotated[int, Field(strict=True), BeforeValidator(_own_whole)]
Vector = Annotated[tuple[Number, Number, Number], AS_LIST]
PlainTable = Annotated[dict[str, Any], BeforeValidator(_own_table)]


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
            SceneError: the first fault, with its key, and the keys of further ones.
        """
        try:
            return cls.model_validate(content)
        except ValidationError as error:
            first, *others = faults_of(error, written=content)
            raise first.of_file(source, others) from None

    @classmethod
    def completed(cls, content: dict[str, Any]) -> dict[str, Any]:
        """The content of a part with its short forms written out, before it is checked."""
        return content

    @model_validator(mode="wrap")
    @classmethod
    def _in_whole(cls, content: object, by_keys: ModelWrapValidatorHandler[Self]) -> Self:
        # Dictionaries of objects may have been changed since these were checked.
        if isinstance(content, cls):
            if type(content) is cls and content.unchanged:
                return content
            content = content.as_given()
        if isinstance(content, Mapping):
            known_keys(content, (*cls.model_fields, *cls.short_forms))
            content = cls.completed(dict(content))
        part = by_keys(content)
        part.agree()
        part._checked = part.model_dump()
        return part

    def agree(self) -> None:
        """Check that the values of the keys agree with each other.

        Raises:
            ValueError: what is wrong.
        """

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
