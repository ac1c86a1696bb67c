"""Pinocchio, or one line that says how to get it; all modules get it here."""

from absolute.errors import MissingPinocchioError

try:
    import pinocchio as pin
except ImportError as error:
    # It may be there and not load, as in a slim container, where libgomp.so.1 is not.
    raise MissingPinocchioError(
        f"the absolute model needs Pinocchio ({error}): pip install 'pointcoord[validate]', or the system's "
        "package with the library that is named, such as libgomp1"
    ) from None

__all__ = ["pin"]
