"""Pinocchio, or one line that says how to get it; all modules get it here."""

from absolute.errors import MissingPinocchioError

try:
    import pinocchio as pin
except ModuleNotFoundError as error:
    raise MissingPinocchioError(
        f"the absolute model needs Pinocchio ({error}): pip install 'pointcoord[validate]'"
    ) from None
except ImportError as error:
    # As in a slim container, where libgomp.so.1 is not.
    raise MissingPinocchioError(
        f"the absolute model needs Pinocchio, which is there and does not load ({error}): "
        "install the system's package with the library that is named, such as libgomp1"
    ) from None

__all__ = ["pin"]
