"""Runs a detector of the user's own: an ONNX model that finds and labels things in colour images."""
