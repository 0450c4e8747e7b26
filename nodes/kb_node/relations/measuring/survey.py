"""Spatial relations of many solids at once: the clear results of `Space.spatial_relations`.

A relation is *clear* if two conditions hold. Its values are further from each threshold than rounding
errors, and only upright boxes, discs and level tops decide it. An example is a cup in the middle of a
table. Arrays decide such cases. A solid with any unclear neighbour is `open` and measured one by one, so
that the result is the same.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import chain
from typing import Final

import numpy as np

from semmap.nodes.kb_node.relations.geometry import planar
from semmap.nodes.kb_node.relations.geometry.columns import Columns
from semmap.nodes.kb_node.relations.geometry.form_columns import Bools, Floats, Ints
from semmap.nodes.kb_node.relations.geometry.planar import GUARD
from semmap.nodes.kb_node.relations.geometry.solids import Solid
from semmap.nodes.kb_node.relations.measuring import containment, places, proximity
from semmap.nodes.kb_node.relations.measuring.broad_phase import (
    BroadPhase,
    find_cells,
    repeat_rows,
    sort_unique,
    starts_run,
)
from semmap.nodes.kb_node.relations.measuring.space import Space
from semmap.nodes.kb_node.relations.measuring.support_pairs import find_supports
from semmap.nodes.kb_node.relations.measuring.thresholds import Thresholds

NO_ROW: Final = -1
_NEAREST_M = 0.01
"""Gaps that differ by more are never equal to the centimetre."""


class Survey:
    """The clear spatial relations of some solids, as arrays with one row each."""

    def __init__(self, space: Space, subjects: Sequence[Solid]) -> None:
        """Compute the relations of `subjects`, which are objects of the space, not places."""
        count = len(subjects)
        self._space: Final = space
        self._limits: Final = space.limits
        self._columns: Final = Columns(_with_neighbours(space, subjects))
        self.solids: Final[Sequence[Solid]] = self._columns.solids
        """The subjects, followed by the solids around them. Rows below refer to it."""
        self.holders: Final = space.holders
        """The holders of attached objects, by name."""
        self.is_open = np.zeros(count, dtype=bool)
        """(S,) whether container, support and place must be measured."""
        self.may_hang = np.zeros(count, dtype=bool)
        """(S,) whether attachments must be measured."""
        self.hangs_on: dict[int, list[int]] = {}
        """By row, the attachments of solids for which they need not be measured."""
        self.container: Final[Ints] = np.full(count, NO_ROW)
        """(S,) rows of `solids`: the container of each that is not open, or `NO_ROW`."""
        self.support: Final[Ints] = np.full(count, NO_ROW)
        self.place: Final[Ints] = np.full(count, NO_ROW)
        if _are_usual(space.limits):
            with np.errstate(all="ignore"):  # solids very far away are never clear, whatever the result
                self._compute()
        else:
            self.is_open[:] = self.may_hang[:] = True

    def _compute(self) -> None:
        limits, columns, grid = self._limits, self._columns, self._space.grid
        broad = BroadPhase(grid, columns.solids, columns.bounds, len(self.is_open))
        one, other, unknown = self._pairs(broad, limits.attached_m)
        self.is_open |= unknown
        self.may_hang |= unknown
        hanging = self._find_attachment_pairs(one, other)
        if grid.crowds:
            one, other, _ = self._pairs(broad, 0.0)
        else:
            its, their = columns.bounds[one], columns.bounds[other]
            meets = (their[:, :2] <= its[:, 2:]).all(axis=1) & (their[:, 2:] >= its[:, :2]).all(axis=1)
            one, other = one[meets], other[meets]
        to_place = columns.is_place[other]
        self._find_places(one[to_place], other[to_place])
        self._find_containers_and_supports(one[~to_place], other[~to_place])
        self.may_hang |= columns.is_fixed[: len(self.may_hang)]
        self._find_attachments(*hanging)

    def _pairs(self, broad: BroadPhase, margin_m: float) -> tuple[Ints, Ints, Bools]:
        """Return the pairs as in `Space.supporters_around`, and the rows that are incomplete."""
        columns, grid = self._columns, self._space.grid
        one, other, unknown = broad.pairs(margin_m)
        if grid.crowds:
            counts = np.array([grid.counts(solid) for solid in self.solids[: len(unknown)]], dtype=bool)
            may_support = (
                counts[one] | columns.is_place[other] | (columns.volume[other] > columns.volume[one])
            )
            one, other = one[may_support], other[may_support]
        return one, other, unknown

    def _store_smallest(
        self, into: Ints, one: Ints, other: Ints, size: Callable[[Solid], tuple[float, str]]
    ) -> None:
        """Store the smallest of the containers of each row."""
        rows = sort_unique(other).tolist()
        sizes = [size(self.solids[row]) for row in rows]
        rank = np.zeros(len(self.solids), dtype=np.int64)
        rank[[rows[k] for k in sorted(range(len(rows)), key=sizes.__getitem__)]] = np.arange(len(rows))
        order = np.lexsort((-rank[other], one))
        into[one[order]] = other[order]  # the last one stays

    # Places

    def _find_places(self, one: Ints, other: Ints) -> None:
        """Find the smallest place that contains enough of the footprint."""
        columns, forms, limits = self._columns, self._columns.forms, self._limits
        measured = columns.is_measured[other]
        one, other = one[measured], other[measured]
        form, its = columns.form[one], columns.form[other]
        is_point = ~columns.is_measured[one]
        sure = np.where(is_point, columns.is_near[one], columns.is_sure[one]) & columns.is_sure[other]
        height = columns.position[one, 2] + np.where(is_point, 0.0, forms.size[form, 2] / 2)
        level = np.minimum(height - columns.bottom[other], columns.top[other] - height) + limits.gap_m
        out = level < -GUARD

        u, v = forms.u[its], forms.v[its]
        middle = columns.position[one, :2] - columns.position[other, :2]
        s, t = planar.decompose(middle, u, v)
        a, b = forms.u[form], forms.v[form]
        inside = np.where(
            is_point, planar.are_within(s, t), planar.are_within(*planar.compute_extents(middle, a, b, u, v))
        )
        area = planar.compute_areas(a, b)
        share = np.minimum(
            1.0, planar.compute_intersections(columns.bounds[one], columns.bounds[other]) / area
        )
        doubt = planar.compute_uncertainty(columns.position[one], area)
        is_exact = forms.is_square[form] & forms.is_square[its]
        inside |= ~is_point & is_exact & (share > limits.place_share + doubt)
        out |= np.where(
            is_point, np.maximum(np.abs(s), np.abs(t)) > 1.0 + GUARD, share < limits.place_share - doubt
        )
        inside &= sure & (level > GUARD) & ~out
        for k in np.flatnonzero(~inside & ~(sure & out)).tolist():
            made = places.within(self.solids[one[k]], self.solids[other[k]], limits)
            inside[k] = made is not None and made.holds
        self._store_smallest(
            self.place, one[inside], other[inside], lambda solid: (solid.footprint, solid.name)
        )

    def _compute_floor_heights(self) -> tuple[Floats, Bools]:
        """Return (S,) the height above the floor of the place, and whether there is a place."""
        bottom, has_place = self._columns.bottom, self.place != NO_ROW
        return bottom[: len(self.place)] - np.where(has_place, bottom[self.place], 0.0), has_place

    # Containers and supports

    def _find_containers_and_supports(self, one: Ints, other: Ints) -> None:
        columns, limits = self._columns, self._limits
        below = columns.top[other] >= columns.bottom[one] - limits.gap_m - 2.0 * GUARD
        below &= columns.is_measured[one]
        one, other = one[below], other[below]
        self.is_open[one[columns.is_fixed[one]]] = True  # it may be let into a top
        sure = columns.is_sure[one] & columns.is_near[other]
        self.is_open[one[~sure]] = True
        one, other = one[sure], other[sure]
        self._find_containers(one, other)
        found = find_supports(columns, one, other, limits)
        # The supports of a contained solid are in the same container, and so smaller than it or above it.
        container = self.container[found.upper]
        has_container = container != NO_ROW
        counts = ~has_container | (columns.volume[found.lower] < columns.volume[container])
        counts |= columns.bottom[found.lower] > columns.bottom[container]
        self.is_open[found.upper[counts & (~found.holds | has_container)]] = True
        counts &= found.holds
        self._find_supports(found.upper[counts], found.lower[counts], found.gap_m[counts])

    def _find_containers(self, one: Ints, other: Ints) -> None:
        """Find the smallest hollow that contains enough of the volume, or in which an object stands."""
        columns, forms, limits = self._columns, self._columns.forms, self._limits
        count = forms.hollows.count[columns.form[other]]
        is_smaller = columns.volume[one] < columns.volume[other]
        may = (count > 0) & (is_smaller | (columns.bottom[one] > columns.bottom[other]))
        one, other, count, is_smaller = one[may], other[may], count[may], is_smaller[may]
        if not len(one):
            return
        pair, turn = repeat_rows(count)
        i, j = one[pair], other[pair]
        form, its = columns.form[i], columns.form[j]
        hollow = forms.hollows.first[its] + turn
        z, floor, lid = columns.position[i, 2], forms.hollows.floor[hollow], forms.hollows.lid[hollow]
        base = columns.position[j, 2]
        height = np.minimum(base + lid, z + forms.size[form, 2]) - np.maximum(base + floor, z)
        middle = columns.position[j, :2] + forms.hollows.centre[hollow]
        u, v, a, b = forms.hollows.u[hollow], forms.hollows.v[hollow], forms.u[form], forms.v[form]
        area = planar.compute_areas(a, b)
        shared = planar.compute_intersections(columns.bounds[i], planar.bounds_around(middle, u, v))
        deep = np.maximum(height, 0.0) / columns.volume[i]
        most = np.minimum(area, shared) * deep
        is_round = forms.hollows.is_round[hollow]
        extents = planar.compute_extents(columns.position[i, :2] - middle, a, b, u, v)
        covers = planar.are_within_outline(*extents, is_round)
        is_exact = forms.is_square[form] & forms.is_square[its] & (is_round == 0.0)
        least = np.where(is_exact, most, np.where(covers, area * deep, 0.0))
        is_sealed = forms.hollows.is_sealed[hollow] > 0.0
        walls = 2.0 * np.sort([np.hypot(*u.T), np.hypot(*v.T)], axis=0)
        spare = containment.FIT * walls - np.sort(forms.size[form, :2], axis=1).T
        least[is_sealed | (spare.min(axis=0) < GUARD)] = 0.0
        above = columns.bottom[i] - base
        stands = (above > containment.FLOOR_M - GUARD) & (above < (floor + lid) / 2 + GUARD) & (shared > 0.0)
        stands &= ~is_sealed
        begins = np.cumsum(count) - count
        most, least = np.maximum.reduceat(most, begins), np.maximum.reduceat(least, begins)
        may_stand = np.logical_or.reduceat(stands, begins)
        doubt = planar.compute_uncertainty(columns.position[one], area[begins])
        sure = columns.is_sure[other]
        inside = sure & is_smaller & (least > limits.inside_share + doubt)
        outside = sure & ~may_stand & (~is_smaller | (most < limits.inside_share - doubt))
        for k in np.flatnonzero(~inside & ~outside).tolist():
            made = containment.inside(self.solids[one[k]], self.solids[other[k]], limits)
            inside[k] = made is not None and made.holds
        self._store_smallest(
            self.container, one[inside], other[inside], lambda solid: (solid.volume, solid.name)
        )

    def _find_supports(self, one: Ints, other: Ints, gap: Floats) -> None:
        """Find the nearest support below, including the floor of the place."""
        floor, has_place = self._compute_floor_heights()
        asked = np.zeros(len(floor), dtype=bool)
        asked[one] = True
        on_floor = np.flatnonzero(asked & has_place & (np.abs(floor) < self._limits.gap_m + GUARD))
        one = np.concatenate([one, on_floor])
        other = np.concatenate([other, np.full(len(on_floor), NO_ROW)])
        away = np.abs(np.concatenate([gap, floor[on_floor]]))
        order = np.lexsort((away, one))
        one, other, away = one[order], other[order], away[order]
        is_nearest = starts_run(one)
        self.support[one[is_nearest]] = other[is_nearest]
        # The supports of a solid in a tray are not below the tray, however near they are.
        self.is_open[
            one[~is_nearest & (self._columns.forms.hollows.count[self._columns.form[other]] > 0)]
        ] = True
        second = np.flatnonzero(is_nearest[:-1] & ~is_nearest[1:]) + 1
        tied = second[away[second] - away[second - 1] < _NEAREST_M + GUARD]
        self.is_open[one[tied]] = True

    # Attachments

    def _find_attachment_pairs(self, one: Ints, other: Ints) -> tuple[Ints, Ints]:
        """Return the pairs whose second clearly holds the first, unless that has a support."""
        columns, forms, limits = self._columns, self._columns.forms, self._limits
        asked = columns.is_measured[one] & ~columns.is_place[other]
        one, other = one[asked], other[asked]
        bottom, top = columns.bottom[one], columns.top[one]
        alongside = (np.minimum(top, columns.top[other]) - bottom) / np.maximum(
            top - bottom, 1e-12
        ) - proximity.ALONGSIDE
        above = bottom - columns.bottom[other] - limits.gap_m
        is_near = columns.is_near[one] & columns.is_near[other]
        may = ((alongside > -GUARD) & (above > -GUARD)) | ~is_near
        one, other, alongside, above = one[may], other[may], alongside[may], above[may]
        apart = np.maximum(
            columns.bounds[one, :2] - columns.bounds[other, 2:],
            columns.bounds[other, :2] - columns.bounds[one, 2:],
        )
        slack = min(limits.attached_m, proximity.BESIDE_M) - np.sqrt(
            (np.maximum(apart, 0.0) ** 2).sum(axis=1)
        )
        exact = is_near[may] & forms.is_square[columns.form[one]] & forms.is_square[columns.form[other]]
        plain = exact & columns.is_sure[one] & (np.minimum(alongside, above) > GUARD) & (slack > GUARD)
        self.may_hang[one[~plain & ~(exact & (slack < -GUARD))]] = True
        return one[plain], other[plain]

    def _find_attachments(self, one: Ints, other: Ints) -> None:
        """Store the attachments of solids without a support."""
        floor, has_place = self._compute_floor_heights()
        away = np.abs(floor) - self._limits.gap_m
        is_borne = (self.container != NO_ROW) | (self.support != NO_ROW) | (has_place & (away < -GUARD))
        may_be_borne = self.is_open | (has_place & (np.abs(away) <= GUARD))
        self.may_hang &= self.is_open | ~is_borne
        self.may_hang[one[may_be_borne[one]]] = True
        hangs = ~is_borne[one] & ~self.may_hang[one]
        for row, its in zip(one[hangs].tolist(), other[hangs].tolist(), strict=True):
            self.hangs_on.setdefault(row, []).append(its)


def _with_neighbours(space: Space, subjects: Sequence[Solid]) -> Sequence[Solid]:
    """Return the subjects, followed by the solids that may be beside them."""
    if 2 * len(subjects) > len(space.solids):
        return list(dict.fromkeys(chain(subjects, space.solids.values())))
    return space.grid.find_counted_in(find_cells(subjects, space.limits.attached_m), subjects)


def _are_usual(limits: Thresholds) -> bool:
    """Return whether the thresholds are in the range for which clear cases were defined."""
    return (
        all(1e-3 <= share <= 1.0 for share in (limits.place_share, limits.inside_share))
        and limits.base_share <= 1.0
        and limits.contact_m < _NEAREST_M
        and limits.contact_m <= limits.gap_m
    )
