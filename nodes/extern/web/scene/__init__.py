"""The scene in three dimensions, drawn by viser in a frame of the page."""
