"""How fast the simulator is: by itself, and in the whole system."""
