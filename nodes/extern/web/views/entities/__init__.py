"""Entities as rows, facts, forms and states, without a browser."""
