"""Pinocchio and its linear algebra, or one line that says how to get them; all modules get them here."""

from absolute.errors import MissingPinocchioError

try:
    import eigenpy
    import pinocchio as pin
except ImportError as error:
    raise MissingPinocchioError(
        f"the absolute model needs Pinocchio ({error}): pip install 'pointcoord[validate]'"
    ) from None

__all__ = ["eigenpy", "pin"]
