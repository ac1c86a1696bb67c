"""Poses certified, and where their points exactly are."""
