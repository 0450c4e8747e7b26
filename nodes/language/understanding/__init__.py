"""What is asked of a robot in words: frames, roles, and the entities they name."""
