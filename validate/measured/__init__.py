"""Result files, measured or printed by another program, held to the car of a scene."""
