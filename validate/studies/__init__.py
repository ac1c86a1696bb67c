"""Long runs of one process: claims, mutants."""
