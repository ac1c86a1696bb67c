"""Pinocchio, or one line that says how to get it; all modules get it here."""

from absolute.errors import MissingPinocchioError

try:
    import pinocchio as pin
except ImportError as error:
    raise MissingPinocchioError(
        f"the absolute model needs Pinocchio ({error}): pip install 'pointcoord[validate]'"
    ) from None

__all__ = ["pin"]
