"""Many members of one quadratic map solved together: a member is a column, and all lie side by side.

One numpy call does one operation of a small matrix for all members, at about a nanosecond each, where one
LAPACK call a member costs microseconds. What is the same for all members is a matrix product.
"""
