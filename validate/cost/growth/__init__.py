"""How time and memory grow with instants, with designs and with unknowns."""
