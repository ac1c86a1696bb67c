"""The formulations that can be compared, behind one contract."""
