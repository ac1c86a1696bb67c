"""Time and peak memory against instants, designs and unknowns, each size in a process of its own."""
