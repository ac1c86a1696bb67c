"""Series in several inputs, proven on patches that cover a range of the inputs on one branch."""
