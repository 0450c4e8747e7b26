"""Obstacles: the colliding geoms of a scene at one moment, and which body may stand on which."""

from __future__ import annotations

import mujoco
import numpy as np

from semmap.nodes.sim_node.bodies import BodyIndex, BodyRecord, Floats, Ints

TOLERANCE_M = 0.004
"""Smaller overlap is resolved by contact forces."""

CLEARANCE_M = 0.0005
SAME_SPOT_M = 0.02
LOW_M = 0.2
GROUND = -1
# as numbers, which NumPy compares a hundred times faster than MuJoCo's enumeration
_PLANE, _HEIGHTS = int(mujoco.mjtGeom.mjGEOM_PLANE), int(mujoco.mjtGeom.mjGEOM_HFIELD)
_FLAT = (
    _PLANE,
    int(mujoco.mjtGeom.mjGEOM_BOX),
    int(mujoco.mjtGeom.mjGEOM_CYLINDER),
    int(mujoco.mjtGeom.mjGEOM_MESH),
)


class Obstacles:
    """The colliding geoms of a scene at one moment. Rows are those of the index; `GROUND` is the world.

    `standing` (N,) marks bodies that are obstacles. Attached bodies are not, since they move with their
    holder.
    """

    def __init__(
        self, model: mujoco.MjModel, data: mujoco.MjData, index: BodyIndex, records: dict[str, BodyRecord]
    ) -> None:
        self._model, self._data, self._index = model, data, index
        self._records = [records[name] for name in index.names]
        self.standing = np.array([not (r.ghost or r.held_by) for r in self._records], dtype=bool)
        self._bottoms = index.poses(data)[:, :3]
        rows = np.full(model.nbody, GROUND)
        rows[index.body] = np.arange(len(index.names))
        self._owner = rows[model.body_rootid][model.geom_bodyid]  # a part belongs to its parent
        felt = (model.geom_contype | model.geom_conaffinity) != 0
        for row, record in enumerate(self._records):
            if record.ghost:
                geoms = np.flatnonzero(self._owner == row)[: len(record.masks)]  # its own come first
                felt[geoms] = [bool(contype | conaffinity) for contype, conaffinity in record.masks]
        self._felt: Ints = np.flatnonzero(felt)
        self._low, self._high = self._boxes()
        order = np.argsort(self._owner[self._felt], kind="stable")
        self._felt, self._low, self._high = self._felt[order], self._low[order], self._high[order]
        owners = self._owner[self._felt]
        self._starts = np.searchsorted(owners, np.arange(-1, len(self._records)))
        self._ends = np.searchsorted(owners, np.arange(-1, len(self._records)), side="right")
        self.body_low, self.body_high = self._body_boxes()
        self.footprint = self.body_high[:, :2] - self.body_low[:, :2]
        self.volume = np.prod(self.body_high - self.body_low, axis=1)

    def _boxes(self) -> tuple[Floats, Floats]:
        """Return bounding boxes of the colliding geoms; a plane fills the space below it."""
        geoms = self._felt
        rotation = self._data.geom_xmat[geoms].reshape(-1, 3, 3)
        aabb = self._model.geom_aabb[geoms]
        centre = self._data.geom_xpos[geoms] + np.einsum("nij,nj->ni", rotation, aabb[:, :3])
        half = np.einsum("nij,nj->ni", np.abs(rotation), aabb[:, 3:])
        low, high = centre - half, centre + half
        plane = self._model.geom_type[geoms] == _PLANE
        low[plane], high[plane, :2] = -np.inf, np.inf
        high[plane, 2] = self._data.geom_xpos[geoms[plane], 2]
        return low, high

    def _slice(self, row: int) -> slice:
        return slice(int(self._starts[row + 1]), int(self._ends[row + 1]))

    def _body_boxes(self) -> tuple[Floats, Floats]:
        count = len(self._records)
        low, high = np.full((count, 3), np.inf), np.full((count, 3), -np.inf)
        has = self._starts[1:] < self._ends[1:]
        if has.any():
            starts = self._starts[1:][has]
            low[has] = np.minimum.reduceat(self._low, starts)
            high[has] = np.maximum.reduceat(self._high, starts)
        return low, high

    def is_fixed(self, row: int) -> bool:
        """Return whether the body is fixed at its pose."""
        return self._records[row].fixed

    def raise_(self, row: int, rise_m: float) -> None:
        """Raise one body, only in this object."""
        here = self._slice(row)
        self._data.geom_xpos[self._felt[here], 2] += rise_m
        for corner in (self._low[here], self._high[here]):
            corner[:, 2] += rise_m
        self._bottoms[row, 2] += rise_m
        self.body_low[row, 2] += rise_m
        self.body_high[row, 2] += rise_m

    def hits(self, row: int, depth_m: float = TOLERANCE_M) -> list[int]:
        """Return the standing rows (and the ground) that the body overlaps by more than `depth_m`."""
        rows = [other for other in self.touched(row, -depth_m) if other != row and self.standing[other]]
        if self._records[row].fixed:
            rows = [other for other in rows if not self._records[other].fixed]
            ground: list[int] = []
        else:
            ground = [GROUND]
        return [other for other in (*ground, *rows) if self._touches(row, other, depth_m)]

    def touched(self, row: int, margin_m: float) -> list[int]:
        """Return all rows whose boxes are within `margin_m` of the body's."""
        near = np.ones(len(self._records), dtype=bool)
        for axis in range(3):  # column by column: ten times as fast as a reduction over three values
            near &= self.body_low[:, axis] - margin_m < self.body_high[row, axis]
            near &= self.body_high[:, axis] + margin_m > self.body_low[row, axis]
        return np.flatnonzero(near).tolist()

    def _touches(self, row: int, other: int, depth_m: float) -> bool:
        mine, theirs = self._slice(row), self._slice(other)
        overlap = (self._low[mine, None] + depth_m < self._high[None, theirs]) & (
            self._high[mine, None] - depth_m > self._low[None, theirs]
        )
        for a, b in np.argwhere(overlap.all(axis=2)):
            if self._depth(int(self._felt[mine][a]), int(self._felt[theirs][b]), depth_m):
                return True
        return False

    def _depth(self, geom: int, other: int, depth_m: float) -> bool:
        kind = self._model.geom_type[other]
        if kind == _PLANE:
            return True  # its box is exact
        if kind == _HEIGHTS:
            return False
        distance = mujoco.mj_geomDistance(self._model, self._data, geom, other, 1.0, None)
        return bool(distance < -depth_m)

    def carries(self, support: int, row: int) -> bool:
        """Return whether a body may be lifted onto another: it fits on top, and is much smaller or squat."""
        return self._fits(row, self.footprint[support], float(self.volume[support]))

    def _fits(self, row: int, footprint: Floats, volume: float) -> bool:
        fits = bool((np.sort(self.footprint[row]) <= 1.05 * np.sort(footprint)).all())
        height = self.body_high[row, 2] - self.body_low[row, 2]
        squat = height <= 1.5 * self.footprint[row].min()
        return fits and bool(self.volume[row] < 0.2 * volume or squat)

    def shared_spot(self, row: int) -> list[int]:
        """Return supports at the same position as the body, which is therefore meant to be on them."""
        return [other for other in self._at_spot(row) if self._belongs_on(row, other)]

    def small_at_spot(self, row: int) -> list[int]:
        """Return bodies at the same position as a support, which are meant to be on it."""
        return [other for other in self._at_spot(row) if self._belongs_on(other, row)]

    def _at_spot(self, row: int) -> list[int]:
        near = self.standing.copy()
        for axis in range(3):
            near &= np.abs(self._bottoms[:, axis] - self._bottoms[row, axis]) < SAME_SPOT_M
        return [other for other in np.flatnonzero(near).tolist() if other != row]

    def _belongs_on(self, row: int, support: int) -> bool:
        tall = self.body_high[support, 2] - self.body_low[support, 2] > LOW_M
        much_smaller = self.volume[row] < 0.2 * self.volume[support]
        return bool(tall and much_smaller) and not self.is_fixed(row) and self.carries(support, row)

    def surfaces(self, row: int) -> list[tuple[float, int]]:
        """Return flat tops below the body's centre that can carry it and are above its bottom, lowest first.

        Each is returned with its row.
        """
        x, y = ((self.body_low[row] + self.body_high[row]) / 2.0)[:2]
        owners = self._owner[self._felt]
        standing = np.where(owners >= 0, self.standing[owners], True) & (owners != row)
        under = (
            (self._low[:, 0] <= x)
            & (x <= self._high[:, 0])
            & (self._low[:, 1] <= y)
            & (y <= self._high[:, 1])
        )
        flat = np.isin(self._model.geom_type[self._felt], _FLAT)
        found = np.flatnonzero(flat & under & standing & (self._high[:, 2] > self.body_low[row, 2]))
        return sorted(
            (float(self._high[geom, 2]), int(owners[geom]))
            for geom in found
            if (
                self.carries(int(owners[geom]), row)
                if owners[geom] >= 0
                else self._ground_carries(int(geom), row)
            )
        )

    def _ground_carries(self, geom: int, row: int) -> bool:
        extent = self._high[geom] - self._low[geom]
        if np.isinf(extent).any():
            return True  # the floor carries everything
        return self._fits(row, extent[:2], float(extent[0] * extent[1] * self._high[geom, 2]))
