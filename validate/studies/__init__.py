"""Long runs: random scenes, proven bounds, claims."""
