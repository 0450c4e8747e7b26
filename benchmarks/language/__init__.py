"""How well commands are understood: frames, what fills their roles, and which entities are meant."""
