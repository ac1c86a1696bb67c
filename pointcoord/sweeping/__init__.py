"""Many designs of one suspension in one call: the designs, how they are solved, and their results."""
