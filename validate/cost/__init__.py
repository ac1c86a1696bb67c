"""What accuracy costs in time: every way to solve a scene, over its settings, timed and held to the reference."""
