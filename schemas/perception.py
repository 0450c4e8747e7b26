"""Observations of perception and messages of external detectors."""

from __future__ import annotations

from typing import Final

from msgspec import Struct, field

from semmap.schemas.entities import Pose, Probability, Size

MISSING: Final = "not seen where it should stand"
DISPLACED: Final = "something else is in its place"
"""The conflicts of an entity that perception observed to be absent, but may not remove."""


DETECTOR_LAYOUTS = (
    "yolov8",
    "yolo-nms",
    "yolov5",
    "yolox",
    "rtdetr",
    "rtdetr-logits",
    "rtdetr-ultralytics",
    "rfdetr",
)
"""Names of the layouts of a detector's outputs that perception decodes."""
COCO: Final = "coco"
"""Names the classes of COCO instead of a file with names."""
LEAST_SCORE = 0.3
"""Minimum score of a detection, by default."""
SURE: Final = 0.4
"""Minimum probability of a class that is reported in a frame, or believed after several."""


class Observation(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """One observation of an object.

    `class_` is the most specific class with sufficient confidence, and `probability` is the probability of
    this class; for `Object`, that it is of no known class. `candidates` are the leaf classes with
    theirs; if a detector named a superclass, it is among them, with the probability of all its leaves. `pose`
    and `size_m` include hidden parts of the object. `whole` is false if the object is occluded or cut off by
    the image border.
    """

    class_: str = field(name="class")
    probability: Probability
    candidates: dict[str, Probability] = {}
    pose: Pose
    size_m: Size
    points: int
    whole: bool = True
    entity: str = ""
    """The entity of the map that it is associated with, if any."""
    fit: Probability | None = None
    """The quality of the model fit, if one was tried; `pose` is the model's then."""
    shown: bool = False
    """Whether the class comes from an exemplar instead of training."""
    label: str = ""
    """The label of an external detector that matches no class, in its own words."""
    labelled: bool = False
    """Whether an external detector labelled it, with this label or a class."""
    color_rgb: tuple[Probability, Probability, Probability] | None = None
    """The mean colour of its visible surface, if the camera has colours."""


class CameraView(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The view of a frame: `intrinsics` (3, 3) [pixel] and `map_from_camera` (4, 4) [m], row-major."""

    camera: str
    width: int
    height: int
    stamp_ns: int
    intrinsics: tuple[float, ...]
    map_from_camera: tuple[float, ...]


class Observations(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The observations in one frame, or in simultaneous frames of several cameras."""

    stamp_ns: int
    views: tuple[CameraView, ...]
    observations: tuple[Observation, ...]


class SegmentedCloud(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The segmented point cloud of one frame, downsampled for display.

    `positions` (N, 3) little-endian 32-bit floats, map frame [m]; `colors` (N, 3) rgb bytes; `labels` (N,)
    little-endian 16-bit: 0 for no observation, n for the n-th.
    """

    stamp_ns: int
    positions: bytes
    colors: bytes
    labels: bytes


class SeenInFrame(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """One object in a frame of a dataset: as in `Observation`, with its bounding box in the image.

    `box_px`: first column and row, and the column and row after the last [pixel].
    """

    class_: str = field(name="class")
    probability: Probability
    candidates: dict[str, Probability] = {}
    pose: Pose
    size_m: Size
    box_px: tuple[int, int, int, int]
    points: int
    fit: Probability | None = None
    label: str = ""


class DroppedInFrame(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A part of a frame that is not reported as an object, and the reason.

    `box_px`: as in `SeenInFrame`. `points`: the number of its points.
    """

    reason: str
    box_px: tuple[int, int, int, int]
    points: int


class FrameRow(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The objects in one frame of a dataset, and what was dropped; or an error.

    `notes` are doubts about the frame, such as unusual intrinsics.
    """

    frame: str
    objects: tuple[SeenInFrame, ...] = ()
    dropped: tuple[DroppedInFrame, ...] = ()
    notes: tuple[str, ...] = ()
    error: str = ""


class MaskRun(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A mask in COCO's run-length encoding: `counts` are numbers or compressed, in column-major order.

    `size` is (height, width) [pixel]. `label` is the detector's label of the object.
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
    """The detections of a 2-D detector in the camera image that was taken at `stamp_ns`.

    They are given as `masks` or as an `image`. With `alone`, only these objects are considered.
    """

    camera: str
    stamp_ns: int
    width: int
    height: int
    masks: tuple[MaskRun, ...] = ()
    image: MaskImage | None = None
    alone: bool = False
