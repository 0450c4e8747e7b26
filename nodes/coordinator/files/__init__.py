"""Files that describe what stands where, told apart by their content: ABoxes, JSON scenes, HuRIC maps."""
