"""How commits and checkpoints are laid out and compressed on disk."""
