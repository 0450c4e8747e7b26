"""Speed of the simulator, alone and in the whole system."""
