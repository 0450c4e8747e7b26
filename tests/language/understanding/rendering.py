"""Frames in a few lines, with the words of every argument."""

from semmap.schemas.language import Argument, SemanticFrame, Understood


def render(understood: Understood) -> list[str]:
    """Return the frames with their arguments, and what each word denotes."""
    lines = [] if understood.mood == "command" else [f"mood: {understood.mood}"]
    lines += [line for frame in understood.frames for line in _frame(frame)]
    if understood.groundings:
        lines.append("words: " + " ".join(f"{one.token}={one.entity}" for one in understood.groundings))
    return lines


def _frame(frame: SemanticFrame) -> list[str]:
    verb = "-".join(map(str, frame.verb))
    lines = [f"{'not ' if frame.negated else ''}{frame.name} ({verb})"]
    return lines + [f"    {_argument(argument)}" for argument in frame.arguments]


def _argument(argument: Argument) -> str:
    first, last = argument.span
    ambiguous = " ambiguous" if argument.ambiguous else ""
    where = f"{first}-{last}, head {argument.head}"
    return f"{argument.role}: {argument.text} ({where}) = {argument.filler}{ambiguous}"
