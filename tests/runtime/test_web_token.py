import pytest

from semmap.nodes.runtime.web_token import new_token
from semmap.schemas import errors


def test_a_token_is_generated_or_long_enough():
    assert new_token() != new_token()
    assert len(new_token()) >= 32
    assert new_token("a" * 16) == "a" * 16
    for bad in ("short", "a" * 20 + "&", "ä" * 20, "a" * 20 + "\n"):
        with pytest.raises(errors.BadRequest, match="SEMMAP_WEB_TOKEN"):
            new_token(bad)
