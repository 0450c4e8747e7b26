"""Supports of many pairs at once: the clear cases of `measures.on`, on flat tops."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from semmap.nodes.kb_node.relations.geometry.columns import Columns
from semmap.nodes.kb_node.relations.geometry.convex import DEEPEST_M
from semmap.nodes.kb_node.relations.geometry.form_columns import Bools, Floats, FormColumns, Ints
from semmap.nodes.kb_node.relations.geometry.forms import LOWEST_M
from semmap.nodes.kb_node.relations.geometry.planar import (
    GUARD,
    are_within_outline,
    compute_extents,
    decompose,
)
from semmap.nodes.kb_node.relations.measuring.broad_phase import repeat_rows, starts_run
from semmap.nodes.kb_node.relations.measuring.thresholds import Thresholds


class SupportPairs(NamedTuple):
    """Pairs of an upper and a lower solid that may be in contact. All other pairs are apart."""

    upper: Ints
    """(N,) rows."""
    lower: Ints
    holds: Bools
    """(N,) whether the upper one clearly rests on the lower one. False means undecided."""
    gap_m: Floats
    """(N,) height above the lower one [m]."""


class _Meeting(NamedTuple):
    """Pairs of parts that may meet, grouped by pair of solids."""

    pair: Ints
    upper: Ints
    """Rows of parts."""
    lower: Ints
    offset: Floats
    """(N, 2) from the lower solid to the upper one [m]."""
    above: Floats
    """From the top of the lower part to the bottom of the upper one [m]."""
    slack: Floats
    """How far the parts are within the limit of comparison [m]."""

    def restrict(self, slack: Floats) -> _Meeting:
        """Return the pairs that remain within the limit after it is reduced to `slack`."""
        slack = np.minimum(self.slack, slack)
        kept = slack > -GUARD
        return _Meeting(
            self.pair[kept], self.upper[kept], self.lower[kept], self.offset[kept], self.above[kept],
            slack[kept],
        )  # fmt: skip


def find_supports(columns: Columns, one: Ints, other: Ints, limits: Thresholds) -> SupportPairs:
    """Return the support pairs among `one` and `other`, whose bounds meet. `one` stand upright."""
    step = columns.bottom[one] - columns.bottom[other] + limits.contact_m
    is_level = columns.forms.is_level[columns.form[other]]
    may = (columns.bottom[one] - columns.top[other] < limits.gap_m + GUARD) & ((step > -GUARD) | ~is_level)
    one, other, step, is_level = one[may], other[may], step[may], is_level[may]
    parts = columns.forms.parts
    meeting = _find_meeting_parts(
        columns, one, other, np.clip(step, limits.contact_m, limits.gap_m), is_level, limits
    )
    is_first = starts_run(meeting.pair)
    begins = np.flatnonzero(is_first)
    pair = meeting.pair[begins]
    if not len(pair):
        return SupportPairs(pair, pair, pair > 0, meeting.above)
    gap = np.minimum.reduceat(meeting.above, begins)
    is_nearest = meeting.above <= gap[np.cumsum(is_first) - 1] + GUARD

    lower = meeting.lower
    u, v, is_disc = parts.u[lower], parts.v[lower], parts.is_disc[lower]
    over = meeting.offset - parts.centre[lower]
    meets_top = are_within_outline(*decompose(over + parts.lowest[meeting.upper], u, v), is_disc)
    plain = (meeting.slack > GUARD) & (meeting.above > GUARD - DEEPEST_M) & meets_top
    form = columns.form[one[meeting.pair]]
    forms = columns.forms
    low, high = forms.base[form, :2], forms.base[form, 2:]
    a, b = np.zeros_like(low), np.zeros_like(low)
    a[:, 0], b[:, 1] = ((high - low) / 2).T
    carries = are_within_outline(*compute_extents(over + (low + high) / 2, a, b, u, v), is_disc)
    # An object whose base centre is over the top is balanced there, whatever its share.
    carries |= are_within_outline(*decompose(over + _compute_base_centres(forms)[form], u, v), is_disc)
    carries &= parts.low[meeting.upper, 2] - forms.bottom[form] < LOWEST_M - 2.0 * GUARD

    holds = np.logical_and.reduceat(plain | ~is_nearest, begins)
    holds &= np.logical_or.reduceat(carries & is_nearest, begins)
    holds &= (step[pair] > GUARD) | ~is_level[pair]
    one, other = one[pair], other[pair]
    # Exclude pairs in which the lower one rests on the upper one.
    holds &= columns.bottom[other] < columns.bottom[one] - limits.contact_m - GUARD
    return SupportPairs(one, other, holds, gap)


def _find_meeting_parts(
    columns: Columns, one: Ints, other: Ints, most: Floats, is_level: Bools, limits: Thresholds
) -> _Meeting:
    """Return the pairs of parts that `measures.on` compares, with the greatest height `most` above one."""
    parts, form, its = columns.forms.parts, columns.form[one], columns.form[other]
    has_level_tops = is_level & ~columns.forms.has_slopes[its]
    number = parts.count[its]
    pair, turn = repeat_rows(parts.count[form] * number)
    each = number[pair]
    upper, lower = parts.first[form][pair] + turn // each, parts.first[its][pair] + turn % each
    offset = (columns.position[one] - columns.position[other])[pair]
    up = offset[:, 2]
    above = up + parts.low[upper, 2] - parts.high[lower, 2]
    found = _Meeting(pair, upper, lower, offset[:, :2], above, most[pair] - above)
    found = found.restrict(np.where(has_level_tops[pair], above + limits.gap_m, np.inf))
    upper, lower, offset = found.upper, found.lower, found.offset
    up = (columns.position[one, 2] - columns.position[other, 2])[found.pair]
    beside = np.minimum(
        offset + parts.high[upper, :2] - parts.low[lower, :2],
        parts.high[lower, :2] - offset - parts.low[upper, :2],
    )
    return found.restrict(np.minimum(beside.min(axis=1), up + parts.high[upper, 2] - parts.low[lower, 2]))


def _compute_base_centres(forms: FormColumns) -> Floats:
    """Return the (F, 2) centre of a base of one box or cylinder, else NaN."""
    found = np.full((len(forms.footing), 2), np.nan)
    stands_on_one = forms.footing >= 0
    found[stands_on_one] = forms.parts.centre[forms.footing[stands_on_one]]
    return found
