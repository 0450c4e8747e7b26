"""Speed and memory of the knowledge base: the engine alone, the node with its disk, the system over Zenoh."""
