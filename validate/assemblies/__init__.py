"""Counts all assemblies of a knuckle, complex ones too; each is certified and separated from the others."""
