"""The TBox, compiled: what it says, in numbers."""
