"""The hard cases, one file for each group."""
