"""The result of a check with the violations of shapes, without a process."""

import pytest

from semmap.nodes.kb_node.shacl import violations
from semmap.schemas import errors
from semmap.schemas.commands import SHAPES_BYTES, Check


def test_a_large_document_is_rejected():
    violations.require_size(Check(shapes=b"x" * SHAPES_BYTES))
    with pytest.raises(errors.BadFile, match=r"^s\.ttl is larger than 10 MiB; split it into several files$"):
        violations.require_size(Check(shapes=b"x" * (SHAPES_BYTES + 1), filename="s.ttl"))
