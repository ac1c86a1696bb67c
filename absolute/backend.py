"""Pinocchio, or one line that says how to get it; all modules get it here."""

try:
    import pinocchio as pin
except ModuleNotFoundError as error:
    raise ModuleNotFoundError(
        f"the absolute model needs Pinocchio ({error}): pip install 'pointcoord[validate]'", name=error.name
    ) from None
except ImportError as error:
    # As in a slim container, where libgomp.so.1 is not.
    raise ImportError(
        f"the absolute model needs Pinocchio, which is there and does not load ({error}): "
        "install the system's package with the library that is named, such as libgomp1",
        name="pinocchio",
    ) from error

__all__ = ["pin"]
