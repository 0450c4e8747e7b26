"""Answers to questions about the past in words."""
