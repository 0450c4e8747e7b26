"""The recorder's state: the relations."""
