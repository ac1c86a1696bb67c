"""Cars and scenes to try: the paper's, random ones, and where their inputs end."""
