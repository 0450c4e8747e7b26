"""The ABox: individuals in columns, and what follows of them, change by change."""
