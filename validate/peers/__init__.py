"""The same suspensions in other people's programs. Plain data in; no mechanics of ours but for the inputs."""
