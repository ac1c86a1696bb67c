"""What the reference tells of a pose beside points and bodies: one file for a group of effects."""
