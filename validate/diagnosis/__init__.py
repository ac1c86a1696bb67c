"""What would explain that somebody's numbers disagree with ours."""

from validate.diagnosis.explain import Explanation, explain, explain_outcome

__all__ = ["Explanation", "explain", "explain_outcome"]
