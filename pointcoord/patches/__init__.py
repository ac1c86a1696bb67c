"""Series in several inputs, proven in patches that cover a range of these, on one branch."""
