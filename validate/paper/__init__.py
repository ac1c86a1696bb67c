"""The paper: its tables, its errata and its formulas as printed."""
