"""Imports Pinocchio for the package; if it is missing, the error says how to install it."""

try:
    import pinocchio as pin
except ModuleNotFoundError as error:
    raise ModuleNotFoundError(
        f"the absolute model needs Pinocchio ({error}): pip install 'pointcoord[validate]'", name=error.name
    ) from None
except ImportError as error:
    # For example in a minimal container without libgomp.so.1.
    raise ImportError(
        f"the absolute model needs Pinocchio, which is installed and does not load ({error}): "
        "install the system package of the missing library, such as libgomp1",
        name="pinocchio",
    ) from error

__all__ = ["pin"]
