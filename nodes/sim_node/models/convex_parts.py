"""A model's parts as the knowledge base stores them: sums of segments, ellipsoids and hulls."""

from __future__ import annotations

from semmap.nodes.sim_node.models.parts import Floats, Part, Shape, rotation_matrix
from semmap.ontology.model_shapes import ConvexPart, Corner
from semmap.schemas import errors


def convex_part(part: Part) -> ConvexPart:
    """Convert a colliding part. A mesh is replaced by its convex hull, as it collides."""
    rotation = rotation_matrix(part.turn)
    x, y, z = _columns(rotation * part.half)
    match part.shape:
        case Shape.BOX:
            return ConvexPart(centre=part.centre, straight=(x, y, z))
        case Shape.ELLIPSOID:
            return ConvexPart(centre=part.centre, round=(x, y, z))
        case Shape.CYLINDER:
            return ConvexPart(centre=part.centre, straight=(z,), round=(x, y))
        case Shape.CAPSULE:
            return ConvexPart(
                centre=part.centre, straight=(z,), round=tuple(_columns(rotation * part.half[0]))
            )
        case Shape.MESH:
            return ConvexPart(centre=part.centre, points=tuple(_columns((_hull(part) @ rotation.T).T)))


def _columns(matrix: Floats) -> list[Corner]:
    return [(float(x), float(y), float(z)) for x, y, z in matrix.T]


def _hull(part: Part) -> Floats:
    """Return the corners (N, 3) of a mesh's hull [m]."""
    from scipy.spatial import ConvexHull

    if part.mesh is None:
        raise errors.InternalError("the part is not a mesh")
    corners: Floats = part.mesh.vertices[ConvexHull(part.mesh.vertices).vertices]
    return corners
