"""Settings of the perception node."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Literal

from semmap.nodes.bus import Network


@dataclass(frozen=True)
class TrackingConfig:
    """When the map is told what was seen. A look is what all cameras see at one moment."""

    confirm_looks: int = 3
    """Looks in which a thing must be seen at rest before it is an entity."""
    clear_looks: int = 2
    """The same for one that no picture's edge cuts, and whose class is as sure as `clear`."""
    clear: float = 0.8
    part_looks: int = 3
    """The same for one that a picture's edge cuts."""
    vanished_looks: int = 1
    """Looks in a row in which its place must be seen empty before a thing is looked for elsewhere."""
    rest_looks: int = 2
    """Looks in which a known entity must be seen elsewhere, at rest, before it has moved."""
    nudge_looks: int = 8
    """The same where it is still half in its place, which is not seen empty: it may only seem so."""
    kept_looks: int = 40
    """The same where what it would have left of its place is filled: a part of it may have been seen."""
    pushed_m: float = math.inf
    """How far from its place a large thing that has vanished is found again in one of the same kind."""
    odd_looks: int = 15
    """Looks in a row in which a thing of another size fills its place, before an entity is gone."""
    gone_looks: int = 10
    """Looks in a row in which an entity should be seen and is not, before it is gone."""
    still_m: float = 0.02
    """What moves less from one look to the next is at rest."""
    moved_m: float = 0.03
    turned_rad: float = math.radians(20.0)
    """An entity that is off by more than these has moved."""
    resized: float = 0.25
    """An extent that is off by more than this share of it is another size."""
    when_gone: Literal["remove", "mark"] = "remove"
    """What becomes of an entity of perception's own that is gone; an operator's is always marked."""

    @property
    def on_the_move(self) -> TrackingConfig:
        """For looks of which a camera moves: it sees more soon, and other things of the same kind.

        A chair that comes into its picture two metres from one that has gone is another.
        """
        return replace(
            self,
            part_looks=2 * self.part_looks,
            vanished_looks=self.vanished_looks + 2,
            pushed_m=min(self.pushed_m, 0.6),
        )


@dataclass(frozen=True)
class PerceptionConfig:
    """How the node looks, and how it reaches the others."""

    tracking: TrackingConfig = field(default_factory=TrackingConfig)
    network: Network = field(default_factory=Network)
    labels: Mapping[str, str] = field(default_factory=dict)
    """From the labels of a detector of one's own to classes; class names need no entry."""
    lessons: Path | None = None
    """The file in which what people show is kept; without one it is forgotten at the end."""
