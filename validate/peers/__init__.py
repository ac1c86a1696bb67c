"""The same mechanisms in other programs. They get plain data, and none of our mechanics but the inputs."""
