"""Saying what a map holds in paragraphs that a person would write."""
