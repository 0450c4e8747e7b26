"""What holds of two things, by their shapes, with what was measured; who is near whom."""
