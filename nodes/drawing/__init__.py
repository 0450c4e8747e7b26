"""What there is to draw, whoever draws it: figures, colours, surfaces, and the scene as it stands."""
