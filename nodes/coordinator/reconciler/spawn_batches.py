"""Batches in which bodies are ordered from the simulator."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from semmap.schemas.scenes import BodyOrder

BATCH = 500
_USUAL_AREA_M2 = 0.1


def split_orders(orders: Sequence[BodyOrder]) -> Iterator[tuple[BodyOrder, ...]]:
    """The orders in batches, what is wide first, so that a large map appears bit by bit.

    Each doubles what is there: for each the simulator compiles everything anew. Within a batch it sees to it
    itself that supports come before what stands on them.
    """
    if len(orders) > BATCH:
        orders = sorted(orders, key=lambda order: -_area_m2(order))
    start = 0
    while start < len(orders):
        end = start + max(BATCH, start)
        yield tuple(orders[start:end])
        start = end


def _area_m2(order: BodyOrder) -> float:
    return _USUAL_AREA_M2 if order.size_m is None else order.size_m[0] * order.size_m[1]
