"""Frozen data classes whose mappings and arrays are read-only, also after pickling."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields
from types import MappingProxyType
from typing import Any, ClassVar

import numpy as np


class ReadOnly:
    """A data class that makes its mappings and arrays read-only; a pickle makes it again from its fields."""

    __dataclass_fields__: ClassVar[dict[str, Any]]

    def __post_init__(self) -> None:
        for field in fields(self):
            value = getattr(self, field.name)
            if isinstance(value, Mapping):
                object.__setattr__(self, field.name, MappingProxyType(dict(value)))
            for array in value.values() if isinstance(value, Mapping) else [value]:
                if isinstance(array, np.ndarray):
                    array.setflags(write=False)

    def __reduce__(self) -> tuple[type, tuple[Any, ...]]:
        # A read-only view of a dictionary cannot be pickled, and arrays come back writeable.
        values = (getattr(self, field.name) for field in fields(self))
        return type(self), tuple(dict(v) if isinstance(v, MappingProxyType) else v for v in values)
