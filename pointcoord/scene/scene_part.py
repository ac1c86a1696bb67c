"""What every part of a scene does: it is checked however it is made, and tells its faults by key."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any, Self, get_args, get_origin

from pydantic import BaseModel, ConfigDict, ValidationError

from pointcoord.errors import SceneError
from pointcoord.scene.messages import problem_of, shown_key


class Part(BaseModel):
    """A part of a scene, frozen, and checked in whatever way it is made."""

    # Parts are checked again wherever they are put: their dictionaries can be written, for one.
    model_config = ConfigDict(frozen=True, extra="forbid", revalidate_instances="always")

    @classmethod
    def checked(cls, content: object, source: str) -> Self:
        """The part as plain data or as an object, checked.

        Raises:
            SceneError: the first fault, with its key; further ones are counted.
        """
        try:
            return cls.model_validate(content)
        except ValidationError as error:
            raise _scene_error(cls, source, error) from None

    def model_copy(self, *, update: Mapping[str, Any] | None = None, deep: bool = False) -> Self:
        """A copy with other values, which are checked.

        Raises:
            SceneError: a value is not allowed, or there is no such key.
        """
        copy = super().model_copy(deep=deep)
        if not update:
            return copy
        given = {name: getattr(copy, name) for name in self.model_fields_set}
        return type(self).checked({**given, **update}, f"a changed {type(self).__name__}")

    @classmethod
    def model_construct(cls, _fields_set: set[str] | None = None, **values: Any) -> Self:
        """The part from its values, which are checked.

        Raises:
            SceneError: a value is not allowed, or there is no such key.
        """
        return cls.checked(values, f"a new {cls.__name__}")


def _scene_error(root: type[BaseModel], source: str, error: ValidationError) -> SceneError:
    faults = error.errors(include_url=False)
    first = faults[0]
    key = ".".join(shown_key(part) for part in first["loc"])
    problem, allowed = problem_of(first), ""
    if first["type"] == "extra_forbidden":
        problem, allowed = "there is no such key", ", ".join(_keys_at(root, first["loc"][:-1]))
    if len(faults) > 1:
        problem += f" (and {len(faults) - 1} more)"
    return SceneError(source, key, problem, allowed)


def _keys_at(part: type[BaseModel], place: tuple[int | str, ...]) -> tuple[str, ...]:
    """The keys that a part may have at a place inside it."""
    named_by_user = False
    for key in place:
        if not named_by_user:
            annotation = part.model_fields[str(key)].annotation
            part, named_by_user = next(_parts(annotation)), get_origin(annotation) is dict
        else:
            named_by_user = False
    return tuple(part.model_fields)


def _parts(annotation: Any) -> Iterator[type[BaseModel]]:
    """The kinds of part that an annotation speaks of."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        yield annotation
    for argument in get_args(annotation):
        yield from _parts(argument)
