"""Baselines: planes and DBSCAN for segmentation, chance for classification."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from msgspec import structs
from numpy.typing import NDArray

from semmap.nodes.perception_node.input.cloud import Cloud
from semmap.nodes.perception_node.pipeline import FrameResult, observe_views
from semmap.nodes.perception_node.recognition.recognition_model import CLUTTER, UNKNOWN, RecognitionModel
from semmap.nodes.perception_node.views.segmented_view import SegmentedView, segment_cloud, with_labels

_EVERY = 3
_NEAR_M = 0.02
_FEWEST = 10
_LEAST = 40


def clustered(clouds: Sequence[Cloud], learnt: RecognitionModel) -> FrameResult:
    """Run our pipeline with DBSCAN for the points outside the planes."""
    return observe_views([_dbscan(segment_cloud(cloud)) for cloud in clouds], learnt)


def _dbscan(sight: SegmentedView) -> SegmentedView:
    import open3d

    thin = sight.cloud.points_camera[::_EVERY, ::_EVERY]
    out = np.isfinite(thin[..., 2]) & (sight.planes[::_EVERY, ::_EVERY] == 0)
    points = open3d.geometry.PointCloud(open3d.utility.Vector3dVector(thin[out].astype(float)))
    small = np.zeros(out.shape, np.int32)
    small[out] = np.asarray(points.cluster_dbscan(_NEAR_M, _FEWEST), np.int32) + 1
    labels = np.repeat(np.repeat(small, _EVERY, axis=0), _EVERY, axis=1)
    labels = labels[: sight.planes.shape[0], : sight.planes.shape[1]]
    labels = np.where((sight.planes == 0) & np.isfinite(sight.cloud.points_camera[..., 2]), labels, 0).astype(
        np.int32
    )
    labels[(np.bincount(labels.ravel()) < _LEAST)[labels]] = 0
    return with_labels(sight, labels, frozenset())


def guessed(looks: Sequence[FrameResult], learnt: RecognitionModel) -> Iterator[FrameResult]:
    """Return the observations with random leaf classes."""
    rng = np.random.default_rng(0)
    leaves: NDArray[np.str_] = np.array([name for name in learnt.classes if name not in (UNKNOWN, CLUTTER)])
    for look in looks:
        drawn = tuple(
            structs.replace(observation, class_=str(rng.choice(leaves)))
            for observation in look.observations.observations
        )
        yield FrameResult(structs.replace(look.observations, observations=drawn), look.labels)
