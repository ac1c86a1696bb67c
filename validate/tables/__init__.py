"""Tables of other programs as lines of cells, and the units that their titles say."""
