"""Cars and scenes to try: one of every suspension, random ones, and where their inputs end."""
