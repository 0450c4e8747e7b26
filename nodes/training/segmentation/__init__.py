"""What teaches segmentation which patches are one object."""
