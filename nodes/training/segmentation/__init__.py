"""Training of segmentation: which patches belong to one object."""
