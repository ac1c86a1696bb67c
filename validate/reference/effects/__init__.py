"""Effects: numbers of a pose other than the motion of points and bodies, one file for each group."""
