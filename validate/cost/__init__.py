"""What accuracy costs in time: every way to solve a scene, timed and held to the reference."""
