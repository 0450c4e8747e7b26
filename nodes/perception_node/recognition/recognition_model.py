"""The trained recognition model and its file of arrays and a description, without code."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from semmap.nodes.perception_node.recognition.features import SORTS
from semmap.nodes.perception_node.recognition.open_set import OpenSetDetector
from semmap.nodes.perception_node.recognition.perceptron import Perceptron
from semmap.nodes.perception_node.segmentation.trees import Trees
from semmap.nodes.perception_node.views.boxes import Numbers
from semmap.schemas.entities import Size
from semmap.schemas.errors import BadFile

if TYPE_CHECKING:
    from semmap.nodes.perception_node.image_features.image_evidence import ImageEvidence
    from semmap.nodes.perception_node.recognition.exemplars import ExemplarMatcher

SHIPPED = Path(__file__).with_name("recognition.npz")

UNKNOWN = "Object"
"""The class of a thing of no known class."""

CLUTTER = ""
"""The leaf for what is not a thing: a table's edge, a leg, a piece of something."""

VOTERS: Mapping[str, tuple[str, ...]] = {
    **{sort: (sort,) for sort in SORTS},
    "all": SORTS,
    "all_again": SORTS,
    "without_relief": SORTS[:-1],
}
"""The voters in the order of the weights, and their sorts of features.

Different features make different errors.
"""

_JOINING = ("feature", "threshold", "keeps", "first", "value")
_NOVELTY = ("mean", "axes", "centres", "weights")


@dataclass(frozen=True)
class RecognitionModel:
    """The trained parameters of recognition.

    `classes`: K leaves, with `UNKNOWN` and `CLUTTER`. `ancestors`: the superclasses of each class, most
    specific first. `sizes_m`: (K, 3) typical long side, short side and height of a leaf. `sideways`: (K,)
    whether a leaf's longer side is its y axis. `voters`: scores (N, K) from the features of each voter.
    `weights`: (voters,) weights of the votes. `familiar`: scores (N, K + 1) of having the exact form of our
    model of a leaf, with "none" last. `joining`: whether two things are pieces of one, from
    `joining.pair_features`. `sides`: see `sides.completed`. `story`: the training data. `exemplars`: things
    that were shown, whose leaves come last. `images`: what images say, if their packages are installed.
    """

    classes: tuple[str, ...]
    ancestors: Mapping[str, tuple[str, ...]]
    sizes_m: Numbers
    sideways: NDArray[np.bool_]
    voters: tuple[Perceptron, ...]
    weights: Numbers
    familiar: Perceptron
    novelty: OpenSetDetector
    joining: Trees
    sides: Perceptron
    story: str
    exemplars: ExemplarMatcher | None = None
    images: ImageEvidence | None = None

    def class_of(self, leaf: str) -> str:
        """Return the class of a leaf; an exemplar's leaf has another name."""
        exemplars = () if self.exemplars is None else self.exemplars.exemplars
        return next((exemplar.class_ for exemplar in exemplars if exemplar.leaf == leaf), leaf)

    @property
    def usual_m(self) -> dict[str, Size]:
        """Return the typical size of things of each class along their own axes [m]."""
        of_leaf = self._usual_m
        return {self.class_of(leaf): of_leaf[leaf] for leaf in reversed(of_leaf)}

    @property
    def _usual_m(self) -> dict[str, Size]:
        return {
            name: (short, long, height) if sideways else (long, short, height)
            for name, (long, short, height), sideways in zip(
                self.classes, self.sizes_m.tolist(), self.sideways.tolist(), strict=True
            )
            if name not in (UNKNOWN, CLUTTER)
        }


def save(learnt: RecognitionModel, path: Path) -> None:
    """Write the model as a compressed NumPy archive, with matrices in half precision."""
    arrays: dict[str, NDArray[np.generic]] = {
        "sizes_m": learnt.sizes_m,
        "sideways": learnt.sideways,
        "weights": learnt.weights,
        **{f"joining.{name}": getattr(learnt.joining, name) for name in _JOINING},
        **{f"novelty.{name}": getattr(learnt.novelty, name).astype(np.float32) for name in _NOVELTY},
    }
    named = zip((*VOTERS, "familiar", "sides"), (*learnt.voters, learnt.familiar, learnt.sides), strict=True)
    for name, perceptron in named:
        arrays |= {f"{name}.mean": perceptron.mean.astype(np.float32)}
        arrays |= {f"{name}.scale": perceptron.scale.astype(np.float32)}
        for layer, (weight, bias) in enumerate(zip(perceptron.weights, perceptron.biases, strict=True)):
            arrays[f"{name}.{layer}.weight"] = weight.astype(np.float16)
            arrays[f"{name}.{layer}.bias"] = bias.astype(np.float32)
    text = {
        "story": learnt.story,
        "joining bias": learnt.joining.bias,
        "classes": learnt.classes,
        "ancestors": dict(learnt.ancestors),
    }
    np.savez_compressed(path, description=np.array(json.dumps(text)), **arrays)  # type: ignore[arg-type]


def load(path: Path = SHIPPED) -> RecognitionModel:
    """Read a model that `save` wrote. Raises BadFile if it is invalid."""
    try:
        with np.load(path, allow_pickle=False) as arrays:
            text = json.loads(str(arrays["description"]))
            return RecognitionModel(
                classes=tuple(text["classes"]),
                ancestors={name: tuple(above) for name, above in text["ancestors"].items()},
                sizes_m=arrays["sizes_m"],
                sideways=arrays["sideways"],
                voters=tuple(_perceptron(arrays, name) for name in VOTERS),
                weights=arrays["weights"],
                familiar=_perceptron(arrays, "familiar"),
                novelty=OpenSetDetector(*(arrays[f"novelty.{name}"].astype(float) for name in _NOVELTY)),
                joining=Trees(
                    **{name: arrays[f"joining.{name}"] for name in _JOINING}, bias=float(text["joining bias"])
                ),
                sides=_perceptron(arrays, "sides"),
                story=text["story"],
            )
    except (OSError, EOFError, ValueError, KeyError) as error:
        raise BadFile(f"{path} is not a valid recognition model: {error}") from None


@lru_cache(maxsize=1)
def shipped() -> RecognitionModel:
    """Return the model that ships with semmap."""
    return load()


def _perceptron(arrays: Mapping[str, NDArray[np.generic]], name: str) -> Perceptron:
    layers = sum(key.startswith(f"{name}.") and key.endswith(".weight") for key in arrays)
    return Perceptron(
        mean=arrays[f"{name}.mean"].astype(float),
        scale=arrays[f"{name}.scale"].astype(float),
        weights=tuple(arrays[f"{name}.{layer}.weight"].astype(float) for layer in range(layers)),
        biases=tuple(arrays[f"{name}.{layer}.bias"].astype(float) for layer in range(layers)),
    )
