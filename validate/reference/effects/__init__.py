"""Effects: the reference's numbers of a pose beside points and bodies. One file for each group of effects."""
