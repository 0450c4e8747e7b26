"""Answers to queries about the map: inferences, explanations, consistency tests and dry runs."""
