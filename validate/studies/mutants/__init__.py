"""Mutation testing of the mathematics: which small changes of it no test would notice."""
