"""The knowledge base's speed and memory: the engine alone, the node on its disk, the system over Zenoh."""
