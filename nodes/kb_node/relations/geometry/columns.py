"""Many solids at once, as arrays."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Final

import numpy as np

from semmap.nodes.kb_node.relations.geometry.form_columns import (
    Bools,
    Extents,
    Floats,
    FormColumns,
    Ints,
    flat,
)
from semmap.nodes.kb_node.relations.geometry.forms import Form
from semmap.nodes.kb_node.relations.geometry.placed_entity import PlacedEntity
from semmap.nodes.kb_node.relations.geometry.solids import Solid, form_in, shape_of
from semmap.schemas.entities import Entity, Vector

_FAR_M = 2e4
"""Beyond this distance rounding errors are no longer far below all thresholds."""
_THIN_M = 1e-4


class Columns:
    """Solids as arrays, one row each, in the given order. Lengths in metres in the map frame."""

    def __init__(self, solids: Sequence[Solid]) -> None:
        self.solids: Final = solids
        forms, row = _index_forms([solid.form for solid in solids])
        self.forms: Final = FormColumns(forms)
        self.form: Final = row
        """(N,) rows of `forms`."""
        self.position: Final[Floats] = flat([solid.position for solid in solids], 3)
        """(N, 3)"""
        self.bounds: Final[Floats] = flat([solid.bounds for solid in solids], 4)
        """(N, 4) least x and y, greatest x and y."""
        self.bottom: Final[Floats] = np.array([solid.bottom for solid in solids])
        self.top: Final[Floats] = np.array([solid.top for solid in solids])
        self.is_place: Final[Bools] = np.array([solid.is_place for solid in solids], dtype=bool)
        self.is_measured: Final[Bools] = np.array([solid.is_measured for solid in solids], dtype=bool)
        self.is_fixed: Final[Bools] = np.array([solid.is_fixed for solid in solids], dtype=bool)
        self.volume: Final[Floats] = self.forms.volume[self.form]
        self.is_near: Final[Bools] = np.abs(self.position).max(axis=1) < _FAR_M
        """Whether it is near enough to the origin to be compared in arrays."""
        is_upright: Bools = self.forms.is_plumb & (self.forms.size.min(axis=1, initial=np.inf) > _THIN_M)
        self.is_sure: Final[Bools] = self.is_near & is_upright[self.form]
        """Whether it also stands upright and is not thin."""


def solids_of(entities: Iterable[Entity | PlacedEntity]) -> list[Solid]:
    """Return the solids of the entities that have a position, as `solid_of` does for each."""
    names: list[str] = []
    positions: list[Vector] = []
    forms: list[Form] = []
    are_places: list[bool] = []
    are_measured: list[bool] = []
    are_fixed: list[bool] = []
    for entity in entities:
        pose = entity.pose
        if pose is not None:
            shape = shape_of(entity)
            names.append(entity.name)
            positions.append(pose.position_m)
            forms.append(form_in(entity, pose, shape))
            are_places.append(entity.place)
            are_measured.append(shape[1] is not None)
            are_fixed.append(entity.fixed)
    each, row = _index_forms(forms)
    reach = Extents(each)
    x, y, z = flat(positions, 3).T
    bounds = np.stack([x, y, x, y], axis=1) + reach.bounds[row]
    bottom = z + reach.bottoms()[row]
    top = z + reach.top[row]
    extents = zip(map(tuple, bounds.tolist()), bottom.tolist(), top.tolist(), strict=True)
    return list(map(Solid, names, positions, forms, are_places, are_measured, extents, are_fixed))


def _index_forms(forms: Sequence[Form]) -> tuple[list[Form], Ints]:
    """Return the distinct forms, and the row of each form."""
    rows = {form: row for row, form in enumerate(dict.fromkeys(forms))}
    return list(rows), np.fromiter(map(rows.__getitem__, forms), np.int64, len(forms))
