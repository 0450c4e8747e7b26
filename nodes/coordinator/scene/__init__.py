"""The scene's side: what must be done so that map and scene agree, and commands to the scene."""
