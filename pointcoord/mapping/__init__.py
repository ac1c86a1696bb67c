"""A suspension's kinematics as a function of its inputs, solved once: a proven map in patches."""
