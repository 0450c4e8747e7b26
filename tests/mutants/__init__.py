"""Mutation testing of a node's code with its own tests: `make mutants`."""
