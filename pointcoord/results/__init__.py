"""What a solved scene is, and how it is made of states."""
