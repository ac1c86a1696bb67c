"""Output: the console, tables, pictures, CSV and JSON files."""
