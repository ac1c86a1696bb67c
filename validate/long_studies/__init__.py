"""Studies of numbered work, recorded as Parquet and worked out by processes or clusters."""
