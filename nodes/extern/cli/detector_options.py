"""The options that select a detector's model, of `perceive`, `up` and `node`."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import click

from semmap.schemas import errors
from semmap.schemas.perception import DETECTOR_LAYOUTS


def detector_options(function: Callable[..., Any]) -> Callable[..., Any]:
    """Add the options of a detector's model."""
    options = [
        click.option(
            "--detector",
            metavar="MODEL.onnx",
            type=click.Path(path_type=Path),
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
            help="Layout of the detector's outputs. Default: recognized by their shapes.",
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


def require_detector(
    detector: Path | None, names: Path | None, layout: str | None, score: float | None
) -> None:
    """Raise BadRequest for options of a detector without a detector."""
    for option, value in (("names", names), ("layout", layout), ("score", score)):
        if detector is None and value is not None:
            raise errors.BadRequest(f"--detector-{option} requires --detector MODEL.onnx")
