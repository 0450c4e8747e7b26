"""The reply to `find` in a few lines."""

from semmap.schemas.language import Candidate, Found


def render(found: Found) -> list[str]:
    """Return outcome and text, the candidates with their reasons, the question and the near matches."""
    lines = [f"{found.outcome}: {found.text}"]
    lines += [f"read as: {said} -> {meant}" for said, meant in found.read_as]
    lines += [f"    {_candidate(one)}" for one in found.candidates]
    lines += [f"? {found.question}"] if found.question else []
    return lines + [f"    near: {_candidate(one)}" for one in found.nearest]


def _candidate(one: Candidate) -> str:
    return f"{one.entity} ({one.class_}, {one.called}): {'; '.join(one.reasons)}"
