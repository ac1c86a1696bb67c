"""What would explain that somebody's numbers disagree with ours."""

from validate.comparison.compare import Explanation
from validate.diagnosis.explain import explain_evidence, explain_outcome

__all__ = ["Explanation", "explain_evidence", "explain_outcome"]
