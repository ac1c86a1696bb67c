"""The same mechanisms in other people's programs. Plain data in; no mechanics of ours but for the inputs."""
