"""Effects: the results beside positions that a scene may request."""
