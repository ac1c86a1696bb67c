"""The refusals of this package: each says what, where, which value, what is allowed, what to try."""

from collections.abc import Mapping

from absolute.solution import Solution


class AbsoluteError(Exception):
    """Base of every error raised here.

    Attributes:
        partial: the motion solved before the failing instant, or None if there is none.
    """

    partial: Solution | None = None


class DescriptionError(AbsoluteError):
    """The description of the linkage is not usable: a name, a point, an axis, the row count.

    Attributes:
        name: the point, body, joint or input at fault.
        value: what was found there.
    """

    def __init__(self, message: str, name: str = "", value: object = None) -> None:
        super().__init__(message)
        self.name, self.value = name, value


class InputError(AbsoluteError):
    """Inputs of a wrong name, shape or value.

    Attributes:
        name: the input at fault.
        instant: index of the first bad instant, or None when the fault is not at one instant.
        value: what was found there.
    """

    def __init__(
        self, message: str, name: str = "", instant: int | None = None, value: object = None
    ) -> None:
        super().__init__(message)
        self.name, self.instant, self.value = name, instant, value


class PoseError(AbsoluteError):
    """Base of the errors about one pose of the mechanism.

    Attributes:
        instant: index of the instant, or None while the drawing itself is being assembled.
        inputs: the inputs asked for, by name (rad or mm).
        reached: the inputs of the last pose that could be solved on the way there.
        condition: estimate of the condition number (1-norm) at that last pose.
        limits: the joints that hold each other there, the strongest first; empty where none do.
        limit: the input that meets the end of its range there, or "" where it was not one of them.
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
        super().__init__(message)
        self.instant, self.condition = instant, condition
        self.inputs, self.reached = dict(inputs or {}), dict(reached or {})
        self.limits, self.limit = limits, limit


class AssemblyError(PoseError):
    """The bodies as drawn cannot be joined by a continuous change of the drawing."""


class UnreachableError(PoseError):
    """No continuous motion of the assembled mechanism leads to these inputs."""


class SingularError(PoseError):
    """The inputs do not fix the pose: the Jacobian has lost rank to working accuracy."""


class MissingPinocchioError(ImportError):
    """Pinocchio or eigenpy cannot be imported; they come with an extra of the package."""
