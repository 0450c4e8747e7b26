"""The planes of a frame of a depth camera, as perception receives them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final, Literal

from semmap.schemas import errors
from semmap.schemas.entities import is_name
from semmap.schemas.scenes import CameraFrame

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import ArrayLike, NDArray

Plane = tuple[Literal["rgb", "depth"], bytes, CameraFrame]
"""The plane, its pixels, and the frame that describes them."""
_ROTATION: Final = 1e-3
"""The largest deviation of a rotation matrix from an orthonormal one."""


def make_planes(
    name: str,
    rgb: ArrayLike,
    depth_m: ArrayLike,
    intrinsics: ArrayLike,
    map_from_camera: ArrayLike,
    stamp_ns: int,
) -> tuple[Plane, Plane]:
    """Return the colour and the depth plane of one frame; see `Client.publish_camera`. Raises BadRequest."""
    import numpy as np

    if not is_name(name):
        raise errors.BadRequest(f"'{name}' is not a valid camera name; use letters, digits and '_'")
    colour, depth = _array(rgb, "rgb"), _array(depth_m, "depth_m")
    if colour.dtype != np.uint8 or colour.ndim != 3 or colour.shape[2] != 3:
        raise errors.BadRequest(f"rgb is {_kind(colour)}; it must be (height, width, 3) of 8-bit numbers")
    if depth.dtype.kind != "f" or depth.shape != colour.shape[:2]:
        height, width, _ = colour.shape
        hint = "; convert millimetres to metres" if depth.dtype.kind in "iu" else ""
        raise errors.BadRequest(
            f"depth_m is {_kind(depth)}; it must be ({height}, {width}) of floats, in metres{hint}"
        )
    fields: dict[str, Any] = {
        "camera": name,
        "width": colour.shape[1],
        "height": colour.shape[0],
        "stamp_ns": stamp_ns,
        "sim_time_s": 0.0,
        "intrinsics": tuple(_intrinsics(intrinsics).ravel().tolist()),
        "map_from_camera": tuple(_pose(map_from_camera).ravel().tolist()),
    }
    metres = np.where(np.isfinite(depth) & (depth > 0.0), depth, 0.0).astype("<f4")
    return (
        ("rgb", np.ascontiguousarray(colour).tobytes(), CameraFrame(encoding="rgb8", **fields)),
        ("depth", metres.tobytes(), CameraFrame(encoding="depth32f", **fields)),
    )


def _intrinsics(values: ArrayLike) -> NDArray[np.float64]:
    """Return the (3, 3) matrix, also from (fx, fy, cx, cy)."""
    import numpy as np

    found = _array(values, "intrinsics").astype(float)
    if found.shape == (4,):
        fx, fy, cx, cy = found
        found = np.array([[fx, 0.0, cx], [0.0, fy, cy], [0.0, 0.0, 1.0]])
    if found.shape != (3, 3) or not np.isfinite(found).all() or min(found[0, 0], found[1, 1]) <= 0.0:
        raise errors.BadRequest(
            "intrinsics must be a (3, 3) matrix or (fx, fy, cx, cy), in pixels, with positive focal lengths"
        )
    return found


def _pose(values: ArrayLike) -> NDArray[np.float64]:
    """Return the (4, 4) pose of the optical frame."""
    import numpy as np

    found = _array(values, "map_from_camera").astype(float)
    is_pose = found.shape == (4, 4) and np.isfinite(found).all() and np.allclose(found[3], (0, 0, 0, 1))
    if not is_pose:
        raise errors.BadRequest("map_from_camera must be a (4, 4) matrix with the last row 0 0 0 1")
    rotation = found[:3, :3]
    if not np.allclose(rotation @ rotation.T, np.eye(3), atol=_ROTATION) or np.linalg.det(rotation) < 0.0:
        raise errors.BadRequest("map_from_camera has no valid rotation: its columns must be orthonormal")
    return found


def _array(values: ArrayLike, name: str) -> NDArray[Any]:
    import numpy as np

    found = np.asarray(values)
    if found.dtype.kind not in "iuf":
        raise errors.BadRequest(f"{name} is not an array of numbers")
    return found


def _kind(found: NDArray[Any]) -> str:
    return f"{found.shape} of {found.dtype}"
