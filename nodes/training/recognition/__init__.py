"""The trainers of recognition: `python -m semmap.nodes.training.recognition`."""
