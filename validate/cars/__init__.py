"""Cars and scenes for tests and studies: base cars, random cars and scenes, and the ends of their inputs."""
