"""The hard cases, one file for each kind of difficulty."""
