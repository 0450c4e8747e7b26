"""Segmentation: dominant planes, and objects, also where they touch."""

from semmap.nodes.perception_node.segmentation.planes import Plane
from semmap.nodes.perception_node.segmentation.segment import Segmentation, segment

__all__ = ["Plane", "Segmentation", "segment"]
