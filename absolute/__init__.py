"""Mechanisms in absolute coordinates: bodies with poses, joints as rows, Newton's method on their poses."""

from absolute.compiler import compile as compile
from absolute.effects import AXLE_EFFECTS as AXLE_EFFECTS
from absolute.effects import EFFECTS as EFFECTS
from absolute.effects import Effect as Effect
from absolute.effects import effects_in as effects_in
from absolute.errors import AbsoluteError as AbsoluteError
from absolute.errors import AssemblyError as AssemblyError
from absolute.errors import DescriptionError as DescriptionError
from absolute.errors import InputError as InputError
from absolute.errors import MissingPinocchioError as MissingPinocchioError
from absolute.errors import PoseError as PoseError
from absolute.errors import SingularError as SingularError
from absolute.errors import UnreachableError as UnreachableError
from absolute.model import Corner as Corner
from absolute.model import Model as Model
from absolute.solution import Solution as Solution
from absolute.solve import Assembled as Assembled
from absolute.solve import ClosedDrawing as ClosedDrawing
from absolute.solve import close_drawing as close_drawing
from absolute.solve import solve as solve
