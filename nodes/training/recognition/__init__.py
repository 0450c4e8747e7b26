"""The trainers of recognition: `python -m nodes.training.recognition`."""
