"""The compiled TBox: its axioms with numbers for classes and properties."""
