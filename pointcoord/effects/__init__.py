"""Effects: the results that a scene may request in addition to positions."""
