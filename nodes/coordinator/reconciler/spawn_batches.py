"""Splits orders for new bodies into batches."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from semmap.schemas.scenes import BodyOrder

BATCH = 500
_USUAL_AREA_M2 = 0.1


def split_orders(orders: Sequence[BodyOrder]) -> Iterator[tuple[BodyOrder, ...]]:
    """Yield the orders in batches, wide bodies first, so that a large map appears step by step.

    Each batch doubles the scene, because the simulator recompiles the whole model for each. Within a batch
    the simulator places supports before the objects on them.
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
