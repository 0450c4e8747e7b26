"""The 3-D scene, drawn by viser in a frame of the page."""
