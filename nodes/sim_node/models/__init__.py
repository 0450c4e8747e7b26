"""The model library: what a body of each class looks like, measures and weighs."""
