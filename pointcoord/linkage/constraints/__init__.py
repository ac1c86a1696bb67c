"""The kinds of constraint; each knows everything about itself."""
