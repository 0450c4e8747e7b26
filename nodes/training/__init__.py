"""Training of the shipped models of perception and language. It is not part of any node."""
