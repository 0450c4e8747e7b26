"""`python -m benchmarks.relations [--parts main|foreign ...] [--errors] [--scenes N] [--json FILE] ...`."""

from __future__ import annotations

import argparse
import json
from pathlib import Path

from benchmarks.relations import accuracy, fact_costs, speed, stability
from benchmarks.relations.foreign import FIRST, LATER
from benchmarks.relations.foreign.comparison import RELATIONS, Compared, compare
from benchmarks.table import Row, as_json, lines


def rows(scenes: int, pairs: int, sizes: list[int], watched_s: float) -> list[Row]:
    """Return the figures of the library's models."""
    on, touches, steep = accuracy.against_contacts(scenes)
    inside = accuracy.inside_against_samples(pairs)
    flat = accuracy.flat()
    rest = stability.at_rest(watched_s)
    facts = fact_costs.measure(10_000, 400)
    moves = {size: speed.move_ms(size) for size in sizes}
    return [
        Row(f"isOn against resting contacts, {scenes} settled scenes: F1", on.f1, "", 0.97, 0.99, more=True),
        Row(f"touches against contacts, {scenes} settled scenes: F1", touches.f1, "", 0.97, 0.99, more=True),
        Row(
            f"isOn of what only steeper contacts bear, {scenes} settled scenes: found",
            steep.right / max(1, steep.right + steep.missing),
            "",
            more=True,
        ),
        Row(f"isInside against sampled points, {pairs} pairs: F1", inside.f1, "", 0.97, 0.99, more=True),
        Row("the flat: said by hand and computed", 1 - len(flat.missing) / flat.said, "", 1, 1, more=True),
        Row("the flat: computed beyond what was said", len(flat.extra), "facts", 0, 0),
        Row(
            f"perception watches 20 things at rest, {watched_s:g} s: come and go",
            rest.changes,
            "relations",
            0,
            0,
        ),
        Row("of the 20 things, on the table in the end", rest.on_the_table / rest.things, "", more=True),
        *(Row(f"relations after a move, {size}, p50", ms, "ms", 0.15, 0.08) for size, ms in moves.items()),
        Row(
            f"relations after a move, {max(sizes)} against {min(sizes)}",
            moves[max(sizes)] / moves[min(sizes)],
            "times",
            1.5,
            1.5,
        ),
        Row("all relations of 50 bodies from nothing", speed.from_nothing_ms(50), "ms", 20, 5),
        Row(
            "bulk load of 10 000, CPU time: with against without",
            facts.load.cpu_s / facts.load_without.cpu_s,
            "times",
            1.5,
            1.2,
        ),
        Row("memory an entity for it", facts.kb_per_entity, "kB", 1.5, 0.8),
        Row(
            "over Zenoh, 10 000: a move with against without, p50",
            facts.move_ms / facts.move_without_ms,
            "times",
            1.15,
            1.05,
        ),
        Row("over Zenoh, 10 000: a move with relations, p50", facts.move_ms, "ms"),
    ]


def foreign_rows(first: Compared, later: Compared) -> list[Row]:
    """Return the figures of foreign worlds: all of them, and those drawn before the code was read."""
    whole = Compared.together((first, later))
    worlds = f"{len(FIRST) + len(LATER)} foreign worlds"
    return [
        *(Row(f"{name}, {worlds}: F1", whole.f1(name), "", 0.97, 0.99, more=True) for name in RELATIONS),
        *(
            Row(f"{name}, the {len(FIRST)} drawn first: F1", first.f1(name), "", more=True)
            for name in RELATIONS
        ),
    ]


def main() -> None:
    """Measure, print a table, write JSON."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.relations", description="Spatial relations.")
    parser.add_argument("--scenes", type=int, default=200, help="random settled scenes")
    parser.add_argument("--pairs", type=int, default=2000, help="pairs of a container and a thing")
    parser.add_argument("--sizes", type=int, nargs="+", default=[500, 10_000, 100_000], help="entities")
    parser.add_argument(
        "--watched", type=float, default=120.0, metavar="S", help="duration of observing things at rest [s]"
    )
    parser.add_argument("--parts", choices=("main", "foreign"), nargs="+", default=["main", "foreign"])
    parser.add_argument("--errors", action="store_true", help="list the wrong relations of foreign worlds")
    parser.add_argument("--json", type=Path, metavar="FILE", dest="json_file")
    words = parser.parse_args()
    found: list[Row] = []
    if "main" in words.parts:
        found += rows(words.scenes, words.pairs, words.sizes, words.watched)
    if "foreign" in words.parts:
        first, later = (compare(draw() for draw in worlds) for worlds in (FIRST, LATER))
        found += foreign_rows(first, later)
        for name in (*first.restless, *later.restless):
            print(f"{name}: not at rest, its truth may be wrong")
        if words.errors:
            print(*first.errors, *later.errors, sep="\n")
    print(lines(found))
    if words.json_file is not None:
        words.json_file.write_text(json.dumps([as_json(row) for row in found], indent=1) + "\n")


if __name__ == "__main__":
    main()
