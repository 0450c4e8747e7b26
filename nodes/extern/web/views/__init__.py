"""What the panels of knowledge show, as plain data: pure functions of the map and of replies."""
