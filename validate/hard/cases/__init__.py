"""The hard cases, a family a file."""
