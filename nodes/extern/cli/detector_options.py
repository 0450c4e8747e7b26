"""The options that select a detector, of `perceive`, `up` and `node`."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from semmap.nodes.extern.cli.common import INPUT_PATH, print_error
from semmap.nodes.extern.files import read_label_map
from semmap.nodes.runtime import extras
from semmap.schemas import errors, wording
from semmap.schemas.perception import COCO, DETECTOR_LAYOUTS, LEAST_SCORE

if TYPE_CHECKING:
    from semmap.nodes.perception_node.detector import Detector


def detector_options(function: Callable[..., Any]) -> Callable[..., Any]:
    """Add the options of a detector's model."""
    options = [
        click.option(
            "--detector",
            metavar="MODEL.onnx",
            type=INPUT_PATH,
            help="Detector or instance segmenter to run on colour images (YOLO, RT-DETR, RF-DETR ...).",
        ),
        click.option(
            "--detector-names",
            metavar="NAMES.txt",
            type=click.Path(path_type=Path),
            help="Class names of the detector, one per line; or coco. Default: those in the model.",
        ),
        click.option(
            "--detector-layout",
            type=click.Choice(DETECTOR_LAYOUTS),
            metavar="LAYOUT",
            help=f"Layout of the detector's outputs: {', '.join(DETECTOR_LAYOUTS)}. Default: recognized by"
            " their shapes.",
        ),
        click.option(
            "--detector-score",
            type=click.FloatRange(0.0, 1.0),
            metavar="SCORE",
            help="Minimum score of a detection, 0 to 1. Default: 0.3.",
        ),
    ]
    for option in reversed(options):
        function = option(function)
    return function


def _require_detector(
    detector: Path | None, names: Path | None, layout: str | None, score: float | None
) -> None:
    """Raise BadRequest for options of a detector without a detector, or a score that is not a number."""
    for option, value in (("names", names), ("layout", layout), ("score", score)):
        if detector is None and value is not None:
            raise errors.BadRequest(f"--detector-{option} requires --detector MODEL.onnx")
    if score is not None and math.isnan(score):  # which is in every range
        raise errors.BadRequest("--detector-score must be a number from 0 to 1, such as 0.5")


def detector_of(
    masks: Path | None,
    label_map: Path | None,
    *,
    masks_only: bool,
    each_core: bool,
    detector: Path | None,
    detector_names: Path | None,
    detector_layout: str | None,
    detector_score: float | None,
) -> Detector | None:
    """Return the masks of a detector in files, or its model, if there are any.

    `each_core`: frames are processed on all cores, and the model on one.
    """
    _require_detector(detector, detector_names, detector_layout, detector_score)
    if masks is not None and detector is not None:
        raise errors.BadRequest("--masks and --detector exclude each other; remove one of them")
    if masks is None and detector is None:
        if label_map is not None or masks_only:
            raise errors.BadRequest("--label-map and --masks-only require --masks or --detector")
        return None
    from semmap.nodes.perception_node.detection.detector_model import DetectorModel
    from semmap.nodes.perception_node.detector import Detector
    from semmap.nodes.perception_node.recognition.detector_labels import LabelMap
    from semmap.nodes.perception_node.recognition.recognition_model import shipped

    classes = read_label_map(label_map) if label_map is not None else {}
    labels = LabelMap(shipped(), classes)
    if untrained := sorted({name for name in classes.values() if not labels.is_learnt(name)}):
        hint = errors.did_you_mean(untrained[0], shipped().ancestors)
        print_error(f"note: classes of the label map without training data: {wording.few(untrained)}{hint}")
    if detector is None:
        return None if masks is None else Detector(masks, labels, masks_only)
    least = LEAST_SCORE if detector_score is None else detector_score
    threads = 1 if each_core else 0
    model = DetectorModel(detector, detector_names, detector_layout or "", least, threads)
    print_error(
        f"note: {model.file}: layout {model.layout}, {wording.counted(len(model.names), 'class name')}"
    )
    return Detector(model, labels, masks_only)


def detector_settings(
    model: Path | None, names: Path | None, layout: str | None, score: float | None, *, perception: bool
) -> dict[str, Any]:
    """Return the settings of a detector, whose model was tried. Raises BadFile, BadRequest."""
    _require_detector(model, names, layout, score)
    if model is None:
        return {}
    if not perception:
        raise errors.BadRequest("--detector requires --perception, or with --only the node perception")
    extras.require("semmap up --detector", "perception")
    from semmap.nodes.perception_node.detection.detector_model import DetectorModel

    DetectorModel(model, names, layout or "")
    word = names is not None and str(names) == COCO
    return {
        "detector": str(model.resolve()),
        "detector_names": None if names is None else COCO if word else str(names.resolve()),
        "detector_layout": layout or "",
        "detector_score": LEAST_SCORE if score is None else score,
    }
