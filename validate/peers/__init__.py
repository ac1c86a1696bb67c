"""Mechanisms in other programs, which get plain data and use nothing of our mechanics except the inputs."""
