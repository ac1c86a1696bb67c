"""Pictures of what accuracy costs; they need matplotlib, of the extra `plot`."""
