"""Numbers that other programs printed of a built-in car, with where they come from."""
