"""Numbers and equations, and no linkage: quadratic maps, their solution, series and bounds."""
