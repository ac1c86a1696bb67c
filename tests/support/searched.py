"""How long a search for examples is whose examples take long."""

from hypothesis import settings


def searched(examples: int) -> settings:
    """So many examples; under the long profile as many as any search has."""
    most = settings.default.max_examples if settings.default else examples
    return settings(max_examples=most if most > 100 else examples)
