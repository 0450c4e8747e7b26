"""Steps of commands for a household competition, understood by a system with a given map."""

from __future__ import annotations

import json
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import msgspec

from semmap.schemas.language import Understood
from semmap.testing import own_system

Prediction = dict[str, Any]


def predict(commands: Path, scene: Path) -> dict[str, Prediction]:
    """Start a system with a JSON scene as its map and return what it understands, by the id of each command.

    `commands` is a JSON list of objects with `id` and `sentence`.
    """
    with (
        TemporaryDirectory() as folder,
        own_system(Path(folder), "--no-sim", "--no-record", "--abox", "none") as client,
    ):
        client.load(scene)
        rows = json.loads(commands.read_text("utf-8"))
        return {row["id"]: prediction(client.understand(row["sentence"])) for row in rows}


def prediction(understood: Understood) -> Prediction:
    """Return the part of a result that is scored, as plain JSON values."""
    found = msgspec.to_builtins(understood)
    return {key: found[key] for key in ("steps", "doubts", "unknown", "question", "mood", "answer")}
