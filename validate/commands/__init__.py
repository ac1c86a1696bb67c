"""The commands of the program: each adds its options and is run with a console."""
