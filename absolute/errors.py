"""The refusals of this package: each says what, where, which value, what is allowed, what to try."""

from collections.abc import Mapping

from absolute.solution import Solution


class AbsoluteError(Exception):
    """Base of every error raised here.

    Attributes:
        name: the point, body, joint, input or effect at fault; empty if there is none by itself.
        value: what was found there.
        instant: index of the first bad instant, or None when the fault is not at one instant.
        partial: the motion solved before the failing instant, or None if there is none.
    """

    partial: Solution | None = None

    def __init__(
        self, message: str, name: str = "", value: object = None, instant: int | None = None
    ) -> None:
        super().__init__(message)
        self.name, self.value, self.instant = name, value, instant


class DescriptionError(AbsoluteError):
    """The description of the linkage is not usable: a name, a point, an axis, the row count."""


class InputError(AbsoluteError):
    """Inputs of a wrong name, shape or value; an effect that there is not."""


class PoseError(AbsoluteError):
    """The bodies as drawn do not fit together, or the mechanism does not come to a pose, or to no single one.

    Attributes:
        instant: index of the instant, or None while the drawing itself is being assembled.
        inputs: the inputs asked for, by name (rad or mm).
        reached: the inputs of the last pose that could be solved on the way there.
        condition: estimate of the condition number (1-norm) at that last pose.
        limits: the joints that hold each other there, the strongest first; empty where none do.
        limit: the input that meets the end of its range there, or "" where none does; `name` is the same.
    """

    def __init__(
        self,
        message: str,
        instant: int | None = None,
        inputs: Mapping[str, float] | None = None,
        reached: Mapping[str, float] | None = None,
        condition: float = float("nan"),
        limits: tuple[str, ...] = (),
        limit: str = "",
    ) -> None:
        super().__init__(message, limit, instant=instant)
        self.inputs, self.reached, self.condition = dict(inputs or {}), dict(reached or {}), condition
        self.limits, self.limit = limits, limit


# Names that errors had before they became one; of Pinocchio that is not there Python's own says all.
AssemblyError = UnreachableError = SingularError = PoseError
MissingPinocchioError = ImportError
