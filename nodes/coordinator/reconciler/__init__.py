"""The reconciler: compares map and scene, and corrects one or the other until they agree."""
