"""A person. Depth x, width y, height z [m]."""

from __future__ import annotations

from semmap.nodes.sim_node.models.forms import DARK
from semmap.nodes.sim_node.models.parts import Colour, Parts, about, ball, box, collision, pill, visual


def figure(x: float, y: float, z: float, colour: Colour) -> Parts:
    """A person of capsules, facing +x; it collides as one upright box on its soles."""
    skin: Colour = (0.85, 0.65, 0.52)
    shoulder, hip, head = 0.82 * z, 0.48 * z, 0.13 * z
    torso_radius = 0.3 * y
    limbs = []
    for side in (-1, 1):
        limbs += visual(pill(0.17 * y, hip, (0, side * 0.19 * y, hip / 2), (0.2, 0.25, 0.4)))
        limbs += visual(
            pill(
                0.11 * y, 0.42 * z, (0, side * 0.39 * y, shoulder - 0.19 * z), skin, about("x", side * -0.12)
            )
        )
        limbs += visual(box((0.9 * x, 0.24 * y, 0.05 * z), (0.02, side * 0.19 * y, 0.025 * z), DARK))
    return [
        *limbs,
        *visual(pill(torso_radius, shoulder - hip + 0.12 * z, (0, 0, (shoulder + hip) / 2), colour)),
        *visual(pill(0.09 * y, 0.12 * z, (0, 0, 0.85 * z), skin)),
        *visual(ball((0.11 * z, 0.1 * z, head), (0, 0, z - head / 2), skin)),
        *visual(ball((0.115 * z, 0.105 * z, 0.07 * z), (-0.008, 0, z - 0.034 * z), (0.25, 0.17, 0.1))),
        *collision(box((0.8 * x, 0.9 * y, z), (0.02, 0, z / 2), colour)),
    ]
