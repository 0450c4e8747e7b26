"""What perception saw."""

from __future__ import annotations

from typing import Final

from msgspec import Struct, field

from semmap.schemas.entities import Pose, Probability, Size

MISSING: Final = "not seen where it should stand"
DISPLACED: Final = "something else is in its place"
"""The conflicts of an entity that perception has seen to be gone, and may not remove or is to mark only."""


class Observation(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """One object as it was seen once.

    `class_` is the most special class that is sure enough (`Object` for what is like nothing known), with
    `probability` that the thing is one of it. `candidates` are the leaves of the vote with theirs. `pose` and
    `size_m` are those of the whole object, its hidden part included. `whole` is false when the picture's edge
    cuts it or something hides a part.
    """

    class_: str = field(name="class")
    probability: Probability
    candidates: dict[str, Probability] = {}
    pose: Pose
    size_m: Size
    points: int
    whole: bool = True
    entity: str = ""
    """The entity of the map that it was taken for, once it was."""
    fit: Probability | None = None
    """How well the model of its class fits what was seen, if that was tried; `pose` is the model's then."""
    shown: bool = False
    """Whether its class is that of a thing that was shown, as which it is known rather than by training."""


class CameraView(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Whence a frame was taken: `intrinsics` (3, 3) [pixel] and `map_from_camera` (4, 4) [m], row by row."""

    camera: str
    width: int
    height: int
    stamp_ns: int
    intrinsics: tuple[float, ...]
    map_from_camera: tuple[float, ...]


class Observations(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """All that was seen in one look of one camera, or of several that looked at the same time."""

    stamp_ns: int
    views: tuple[CameraView, ...]
    observations: tuple[Observation, ...]


class SegmentedCloud(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The points of one look, and whose each is. For the eye: thinned out.

    `positions` (N, 3) little-endian 32-bit floats, map frame [m]; `colors` (N, 3) rgb bytes; `labels` (N,)
    little-endian 16-bit: 0 for none of the observations, n for the n-th.
    """

    stamp_ns: int
    positions: bytes
    colors: bytes
    labels: bytes


class SeenInFrame(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """One object in a frame of a dataset: as in `Observation`, and where in the picture.

    `box_px`: first column and row, and those after the last [pixel].
    """

    class_: str = field(name="class")
    probability: Probability
    candidates: dict[str, Probability] = {}
    pose: Pose
    size_m: Size
    box_px: tuple[int, int, int, int]
    points: int
    fit: Probability | None = None


class FrameRow(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """What one frame of a dataset shows, or what is wrong with it."""

    frame: str
    objects: tuple[SeenInFrame, ...] = ()
    error: str = ""


class MaskRun(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A mask as COCO writes it: `counts` are run lengths, column after column, as numbers or compressed.

    `size` is (height, width) [pixel]. `label` is what its thing is taken for, in the detector's own words.
    """

    size: tuple[int, int]
    counts: str | tuple[int, ...]
    label: str = ""
    score: Probability = 1.0


class MaskImage(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Masks as one image: `labels` (H, W) little-endian 16-bit, 0: none, n: what `names[n - 1]` names."""

    labels: bytes
    names: tuple[str, ...] = ()
    scores: tuple[Probability, ...] = ()


class DetectedMasks(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """What a 2-D detector has found in a picture of a camera, which was taken at `stamp_ns`.

    Either `masks` or an `image`. With `alone`, nothing but these is to be found in it.
    """

    camera: str
    stamp_ns: int
    width: int
    height: int
    masks: tuple[MaskRun, ...] = ()
    image: MaskImage | None = None
    alone: bool = False
