"""What is on disk: the journal and its checkpoints, the past, seeding and repair."""
