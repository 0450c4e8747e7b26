"""The model library: shape, size and mass of a body of each class."""
