"""Pinocchio and its linear algebra, or one line that says how to get them; all modules get them here."""


class MissingPinocchioError(ImportError):
    """Pinocchio or eigenpy cannot be imported; they come with an extra of the package."""


try:
    import eigenpy
    import pinocchio as pin
except ImportError as error:
    raise MissingPinocchioError(
        f"the absolute model needs Pinocchio ({error}): pip install 'pointcoord[validate]'"
    ) from None

__all__ = ["MissingPinocchioError", "eigenpy", "pin"]
