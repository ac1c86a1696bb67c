"""The ways that are raced, one family a file; `registry` lists them."""
