"""Every message type of the system, and random messages of a type."""

import inspect as python
import math
from typing import Any

import msgspec
from hypothesis import strategies as st
from msgspec import inspect

from semmap.schemas import (
    bridge,
    commands,
    commits,
    entities,
    errors,
    explanations,
    frames,
    health,
    live,
    perception,
    plans,
    scenes,
)

_MODULES = (
    *(bridge, commands, commits, entities, errors, explanations, frames, health),
    *(live, perception, plans, scenes),
)

TYPES = sorted(
    {
        kind
        for module in _MODULES
        for _, kind in python.getmembers(module, python.isclass)
        if issubclass(kind, msgspec.Struct) and kind.__module__ == module.__name__
    },
    key=lambda kind: kind.__name__,
)
UNIT_QUATERNIONS = st.sampled_from([(1.0, 0.0, 0.0, 0.0), (0.6, 0.0, 0.0, 0.8), (0.5, -0.5, 0.5, -0.5)])


def of(kind: type[msgspec.Struct]) -> st.SearchStrategy[Any]:
    """Messages of type `kind`."""
    return _of(inspect.type_info(kind))


ANGLES = st.floats(-math.tau, math.tau)


def _of_field(field: inspect.Field) -> st.SearchStrategy[Any]:
    """Values of a field. An angle as entered by a user is converted, so it differs from what was sent."""
    is_angle = (
        field.name == "yaw" and isinstance(field.type, inspect.UnionType) and len(field.type.types) == 3
    )
    return st.none() | ANGLES if is_angle else _of(field.type)


def _of(info: inspect.Type) -> st.SearchStrategy[Any]:
    match info:
        case inspect.Metadata(type=inner):
            return _of(inner)
        case inspect.UnionType(types=types):
            return st.one_of(*map(_of, types))
        case inspect.StructType(cls=entities.Pose):
            vector = _of(inspect.type_info(entities.Vector))
            return st.builds(entities.Pose, position_m=vector, orientation_wxyz=UNIT_QUATERNIONS)
        case inspect.StructType(cls=cls, fields=fields):
            return st.builds(cls, **{field.name: _of_field(field) for field in fields})
        case inspect.TupleType(item_types=types):
            return st.tuples(*map(_of, types))
        case inspect.VarTupleType(item_type=item):
            return st.lists(_of(item), max_size=1).map(tuple)
        case inspect.DictType(key_type=key, value_type=value):
            return st.dictionaries(_of(key), _of(value), max_size=1)
        case inspect.LiteralType(values=values):
            return st.sampled_from(values)
        case inspect.FloatType(ge=ge, le=le, gt=gt):
            low = ge if ge is not None else gt
            return st.floats(low, le, exclude_min=gt is not None, allow_nan=False, allow_infinity=False)
        case inspect.IntType(ge=ge, le=le):
            return st.integers(-(2**63) if ge is None else ge, 2**63 - 1 if le is None else le)
        case inspect.StrType(pattern=None, min_length=least, max_length=most):
            return st.text(min_size=least or 0, max_size=min(most or 5, 5))
        case inspect.StrType(pattern=entities.NAME_PATTERN):
            return st.sampled_from(["chair1", "_", "A.b-c_9", "x" * 128])
        case inspect.BytesType():
            return st.binary(max_size=5)
        case inspect.BoolType():
            return st.booleans()
        case inspect.NoneType() | inspect.AnyType():
            return st.none()
    raise NotImplementedError(info)
