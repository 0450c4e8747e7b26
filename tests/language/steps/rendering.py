"""A parsed command in a few lines, with everything that was read of it."""

from semmap.schemas.language import CommandStep, Filler, ThingDescription, Understood


def render(understood: Understood) -> list[str]:
    """Return the steps, and what was answered, is in doubt, is unknown or would be asked."""
    lines = [line for step in understood.steps for line in _step(step)]
    lines += [f"= {understood.answer}"] if understood.answer else []
    lines += [f"! {doubt}" for doubt in understood.doubts]
    lines += [f"unknown: {word}" for word in understood.unknown]
    lines += [f"? {understood.question}"] if understood.question else []
    return lines


def _step(step: CommandStep) -> list[str]:
    when = "".join(f" [{text}]" for text in (step.condition, step.time) if text)
    negation = "not " if step.negated else ""
    lines = [f"{negation}{step.frame} ({step.verb}){when}"]
    for role, fillers in step.roles.items():
        lines += [f"    {role}: {_filler(filler)}" for filler in fillers]
    return lines


def _filler(filler: Filler) -> str:
    text = filler.text.replace(filler.head, f"*{filler.head}*", 1)
    names = f" = {'|'.join(filler.entities)}" if filler.entities else ""
    refers = f" @{filler.refers.step} {filler.refers.role}" if filler.refers else ""
    described = f" {_description(filler.description)}" if filler.description else ""
    return f"{text}{names}{refers}{described}"


def _description(thing: ThingDescription) -> str:
    places = [
        f"{'not ' if place.negated else ''}{place.is_} {'|'.join(place.entities) or f'{place.of!r}'}"
        for place in thing.relation
    ]
    parts = {
        "": thing.class_, "called": thing.called, "name": thing.name,
        "attributes": ", ".join(thing.attributes), "superlative": thing.superlative,
        "number": thing.quantity, "from": thing.at_least, "to": thing.at_most,
        "at": ", ".join(places), "for": thing.purpose, "owner": thing.owner,
        "not": ", ".join(thing.excluded), "or": ", ".join(thing.alternatives),
    }  # fmt: skip
    said = [f"{key} {value}".strip() for key, value in parts.items() if value not in ("", None)]
    return f"({'; '.join(said)})"
