"""Diagnosis: possible explanations of a disagreement between given numbers and pointcoord's."""

from validate.comparison.compare import Explanation
from validate.diagnosis.explain import explain_evidence, explain_outcome

__all__ = ["Explanation", "explain_evidence", "explain_outcome"]
