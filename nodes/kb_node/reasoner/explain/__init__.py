"""Explanations: the reasons of conclusions, minimal sets of asserted triples, and sentences."""
