"""What a solved scene is, how it is made of states, and what is proven of it."""
