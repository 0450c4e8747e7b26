"""Publish frames of a custom camera to perception: python examples/own_camera.py [SECONDS].

Start this system first:

    semmap up --data /tmp/seen --abox none --world empty --truth perceived --perception --camera-hz 0

The example renders a table with a box on it. Replace the images and the pose by those of your camera.
"""

from __future__ import annotations

import sys
import time

import numpy as np
import zenoh
from numpy.typing import NDArray

import semmap
from semmap.wire import OBSERVATIONS, decode

WIDTH, HEIGHT, FOCAL_PX = 640, 480, 525.0
EYE_M = np.array([0.0, -0.9, 1.35])
TARGET_M = np.array([0.0, 0.1, 0.75])
BOXES = (  # low corner, high corner [m], colour
    ((-0.6, -0.3, 0.70), (0.6, 0.5, 0.74), (150, 110, 80)),
    ((-0.05, 0.0, 0.74), (0.15, 0.12, 0.88), (200, 60, 50)),
)
FLOOR = (200, 195, 185)


def map_from_camera() -> NDArray[np.float64]:
    """Return the (4, 4) pose of the optical frame (x right, y down, z forward) at EYE_M, facing TARGET_M."""
    forward = (TARGET_M - EYE_M) / np.linalg.norm(TARGET_M - EYE_M)
    right = np.cross(forward, (0.0, 0.0, 1.0))
    right /= np.linalg.norm(right)
    pose = np.eye(4)
    pose[:3, :3] = np.column_stack([right, np.cross(forward, right), forward])
    pose[:3, 3] = EYE_M
    return pose


def render() -> tuple[NDArray[np.uint8], NDArray[np.float32]]:
    """Return colour (HEIGHT, WIDTH, 3) and depth (HEIGHT, WIDTH) [m] of the boxes and the floor."""
    columns, rows = np.meshgrid(np.arange(WIDTH) + 0.5, np.arange(HEIGHT) + 0.5)
    rays = np.stack(
        [(columns - WIDTH / 2) / FOCAL_PX, (rows - HEIGHT / 2) / FOCAL_PX, np.ones_like(rows)], -1
    )
    rays = rays @ map_from_camera()[:3, :3].T  # with depth 1, in the map frame
    with np.errstate(divide="ignore"):
        depth = np.where(rays[..., 2] < 0.0, -EYE_M[2] / rays[..., 2], np.inf)
        colour = np.broadcast_to(np.array(FLOOR, np.uint8), (*depth.shape, 3)).copy()
        for low, high, tone in BOXES:
            ends = np.stack([(np.array(corner) - EYE_M) / rays for corner in (low, high)])
            enter, leave = ends.min(axis=0).max(axis=-1), ends.max(axis=0).min(axis=-1)
            hit = (enter < leave) & (enter > 0.0) & (enter < depth)
            depth[hit], colour[hit] = enter[hit], tone
    depth[~np.isfinite(depth) | (depth > 4.0)] = 0.0
    return colour, depth.astype("<f4")


def main() -> None:
    """Publish five frames a second, and print new observations and the resulting entities."""
    seconds = float(sys.argv[1]) if len(sys.argv) > 1 else 20.0
    rgb, depth_m = render()
    lens = (FOCAL_PX, FOCAL_PX, WIDTH / 2, HEIGHT / 2)
    printed: set[str] = set()
    with semmap.connect(agent="own camera") as client:

        def show(sample: zenoh.Sample) -> None:
            for seen in decode(sample.payload.to_bytes(), OBSERVATIONS.message).observations:
                line = f"seen: {seen.class_} {[round(x, 1) for x in seen.pose.position_m]}"
                if line not in printed:
                    printed.add(line)
                    print(line, flush=True)

        client.session.declare_subscriber(OBSERVATIONS.key, show)
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            client.publish_camera("mine", rgb, depth_m, lens, map_from_camera())
            time.sleep(0.2)
        for entity in client.list():
            print(f"in the map: {entity.class_} {entity.name}", flush=True)


if __name__ == "__main__":
    main()
