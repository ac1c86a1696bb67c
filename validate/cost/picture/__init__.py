"""Pictures of what accuracy costs; they need matplotlib, of the extra `plot`."""

from __future__ import annotations

import importlib

from validate.extras import MissingPackage

try:
    importlib.import_module("matplotlib")
except ImportError as error:
    raise MissingPackage("validate.cost.picture", error, "plot") from None
