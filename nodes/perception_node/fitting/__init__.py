"""The full pose of what is recognised: its class's model aligned with what was seen of it."""
