"""The reference: the equations of any mechanism in many digits, with a proof of every number.

It shares no code with the formulations that it judges. "Error" means the difference from its numbers.
"""

from validate.extras import needing

with needing("validate.reference"):
    from validate.reference.design import Design as Design
    from validate.reference.errors import InfeasibleError as InfeasibleError
    from validate.reference.errors import NoReferenceError as NoReferenceError
    from validate.reference.errors import NotDecidedError as NotDecidedError
    from validate.reference.errors import SingularPoseError as SingularPoseError
    from validate.reference.instant import Instant as Instant
    from validate.reference.instant import instants_of as instants_of
    from validate.reference.instant import pose_exists as pose_exists
