"""The truth: the equations of both struts in many digits, with a proof of every one.

Third and independent: it shares no code with the formulations it judges. Where the project says
"error" it means the distance from these numbers.
"""

from validate.extras import MissingPackage

try:
    from validate.truth.assemblies import Assemblies as Assemblies
    from validate.truth.assemblies import count_assemblies as count_assemblies
    from validate.truth.branches import Choices as Choices
    from validate.truth.drawing import ClosedDrawing as ClosedDrawing
    from validate.truth.drawing import closed_drawing as closed_drawing
    from validate.truth.errors import AmbiguousAssemblyError as AmbiguousAssemblyError
    from validate.truth.errors import BadInputError as BadInputError
    from validate.truth.errors import InfeasibleError as InfeasibleError
    from validate.truth.errors import NotDecidedError as NotDecidedError
    from validate.truth.errors import SingularPoseError as SingularPoseError
    from validate.truth.errors import TruthError as TruthError
    from validate.truth.instant import Instant as Instant
    from validate.truth.sensitivity import Sensitivity as Sensitivity
    from validate.truth.sensitivity import sensitivities as sensitivities
    from validate.truth.solve import solve_truth as solve_truth
    from validate.truth.time_functions import time_function_value as time_function_value
except ModuleNotFoundError as error:
    raise MissingPackage("validate.truth", error) from None
