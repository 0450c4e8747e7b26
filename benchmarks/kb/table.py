"""The table of measurements and targets."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from benchmarks.kb.disk import Disk
from benchmarks.kb.engine import Engine
from benchmarks.kb.in_turn import SUSTAINED, Pair, Wired
from benchmarks.kb.made import Figures
from benchmarks.kb.scale import Scale
from benchmarks.kb.university import University
from benchmarks.kb.wire import Wire
from benchmarks.table import Row

Bounds = tuple[float | None, float | None]


def of_engine(engines: Sequence[Engine]) -> list[Row]:
    """Single changes at every size, and their growth."""
    rows: list[Row] = []
    for e in engines:
        rows += _pair(f"core: add and check, {e.entities}", e.add, (0.1, 0.5), (0.03, 0.1))
    first, last = engines[0], engines[-1]
    growth = last.add["p50_ms"] / first.add["p50_ms"]
    rows.append(Row(f"core: add, {last.entities} against {first.entities}", growth, "times", 1.5, 1.5))
    rows.append(Row("core: refused add, explained, undone, p50", last.refuse["p50_ms"], "ms", 0.2, 0.05))
    rows.append(Row("core: remove, p50", last.remove["p50_ms"], "ms", 0.1, 0.03))
    rows.append(Row("core: move, p50", last.move["p50_ms"], "ms", 0.1, 0.03))
    rows.append(Row(f"engine memory an entity, {last.entities}", last.kb_per_entity, "kB", 4, 2))
    rows.append(Row("whole process, an entity", last.process_kb_per_entity, "kB", 15, 8))
    return rows


def of_variants(plain: Figures, top: Figures, foreign: Figures | None, size: int) -> list[Row]:
    """Adds with other TBoxes."""
    of = f"core: add and check, {size}"
    rows = [
        Row(f"{of}, p50", plain["p50_ms"], "ms", None, 0.015),
        Row(f"{of}, a top property declared, against without", top["p50_ms"] / plain["p50_ms"], "times", 1.1),
    ]
    if foreign is not None:
        rows.append(Row(f"{of}, SOMA and DUL, p50", foreign["p50_ms"], "ms", 0.1, 0.05))
    return rows


_AGAINST: dict[str, Bounds] = {
    "add": (0.85, None),
    "move": (0.85, None),
    "reference": (0.7, None),
    "remove": (0.7, None),
}
"""The ratio to the previous duration of a command over Zenoh."""


def of_core_in_turn(pairs: Mapping[str, Pair], size: int) -> list[Row]:
    """The engine alone, compared with the previous version."""
    return [
        Row(f"core: {what}, {size}, {pair.before:.4f} ms before, {pair.now:.4f}", pair.ratio, "times", 1.0)
        for what, pair in pairs.items()
    ]


def of_wire_in_turn(wired: Wired, size: int) -> list[Row]:
    """Over Zenoh, compared with the previous version."""
    rows: list[Row] = []
    for what, pair in wired.took.items():
        if what == SUSTAINED:
            said = f"sustained moves, {size}, {pair.before:.0f}/s before, {pair.now:.0f} now"
            rows.append(Row(said, pair.ratio, "times", 1.0, None, more=True))
            continue
        reach, aim = _AGAINST[what]
        said = f"over Zenoh: {what}, {size}, {pair.before:.2f} ms before, {pair.now:.2f} now"
        rows.append(Row(said, pair.ratio, "times", reach, aim))
        rows.append(Row(f"over Zenoh: {what}, {size}, p50", pair.now, "ms", None, 1.0))
    for what, least in wired.floor.items():
        rows.append(Row(f"over Zenoh: {what}: the chain alone, and the disk, p50", least.took_ms, "ms"))
        rows.append(Row(f"CPU time: {what}: the chain alone, and the disk", least.cpu_ms, "ms"))
    for what, pair in wired.cpu.items():
        said = f"CPU time: {what}, {size}, {pair.before:.2f} ms before, {pair.now:.2f} now"
        rows.append(Row(said, pair.ratio, "times"))
    return rows


def of_university_in_turn(pair: Pair, triples: int) -> Row:
    """University data, compared with the previous version."""
    said = f"university data, {triples} triples: CPU time, {pair.before:.2f} s before, {pair.now:.2f} now"
    return Row(said, pair.ratio, "times", 1.0, 0.6)


def of_room(add: Figures, remove: Figures) -> list[Row]:
    """A room with many parts."""
    return [
        Row("core: a room with 10 000 parts: add one, p50", add["p50_ms"], "ms", 1, 0.1),
        Row("core: a room with 10 000 parts: remove one, p50", remove["p50_ms"], "ms", 1, 0.1),
    ]


def of_owlrl(owlrl: Figures, engine: Engine) -> list[Row]:
    """The speed-up of the engine over owlrl, on a map of the same size."""
    times = owlrl["p50_ms"] / engine.add["p50_ms"]
    return [
        Row(f"owlrl: add and check, {engine.entities}", owlrl["p50_ms"], "ms"),
        Row("core against owlrl", times, "times", 10_000, 50_000, more=True),
    ]


def of_university(universities: Sequence[University]) -> list[Row]:
    """University data: all inferences."""
    rows: list[Row] = []
    for found in universities:
        of = f"university data, {found.triples} triples"
        rows.append(Row(f"{of}: load", found.load_s, "s"))
        rows.append(Row("of which CPU time", found.load_cpu_s, "s"))
        rows.append(Row(f"{of}: go through {found.inferred} that follow", found.enumerate_s, "s"))
        rows.append(Row(f"{of}: memory", found.memory_mb, "MB"))
    return rows


def of_reasonable(ours: University, reasonable_s: float) -> Row:
    """The duration for university data relative to `reasonable`, which is written in Rust."""
    whole_s = ours.load_cpu_s + ours.enumerate_cpu_s
    of = f"university data, {ours.triples} triples"
    said = f"{of}: CPU time, reasonable {reasonable_s:.2f} s, ours {whole_s:.2f}"
    return Row(said, whole_s / reasonable_s, "times")


def of_disk(disk: Disk) -> list[Row]:
    """Load, start, list."""
    of = f"{disk.entities} entities"
    return [
        Row(f"bulk load, durable, {of}", disk.bulk_load.wall_s, "s", 1, 0.3),
        Row("of which CPU time", disk.bulk_load.cpu_s, "s"),
        Row(f"start-up from disk, {of}", disk.start_up.wall_s, "s", 2, 1),
        Row("of which CPU time", disk.start_up.cpu_s, "s"),
        Row(f"list all in the node, {of}, p50", disk.list_all["p50_ms"], "ms", 100, 50),
        Row("one write of this disk (fdatasync of 8 kB), p50", disk.sync["p50_ms"], "ms"),
    ]


def of_wire(wire: Wire) -> list[Row]:
    """Client-side figures. There are no targets with the simulator."""
    where = f"{wire.entities} entities, simulator {'on' if wire.sim else 'off'}"
    bounds = ((None, None), (None, None)) if wire.sim else ((2.0, 10.0), (1.0, 4.0))
    rows = _pair(f"over Zenoh: add, {where}", wire.add, *bounds)
    rows += _pair(f"over Zenoh: move, {where}", wire.move, *bounds)
    for what, figures in (("add", wire.awake_add), ("move", wire.awake_move)):
        rows.append(Row(f"{what}, the same with cores kept awake, p50", figures["p50_ms"], "ms"))
    least: Bounds = (None, None) if wire.sim else (1000, 3000)
    sustained = wire.sustained_moves_per_s
    rows.append(Row(f"sustained durable moves, {where}", sustained, "/s", least[0], least[1], more=True))
    rows.append(Row(f"list all over Zenoh, {where}, p50", wire.list_all["p50_ms"], "ms"))
    rows.append(Row(f"SPARQL look-up, {where}, p50", wire.sparql["p50_ms"], "ms", None if wire.sim else 1))
    rows.append(Row(f"semmap up to ready, {where}", wire.start_s, "s"))
    return rows


_OF_SIZE: dict[int, dict[str, Bounds]] = {
    100_000: {
        "load_turtle": (11.5, 5.75),
        "load_json": (8.0, 4.0),
        "start": (5.0, 2.0),
        "first_sparql": (3.0, 1.0),
        "sparql": (0.2, 0.16),
        "list": (0.15, 0.05),
        "check": (20.0, 10.0),
    },
    1_000_000: {"load_turtle": (150.0, 60.0), "memory_gb": (6.0, 4.0), "start": (60.0, 25.0)},
}
"""Return the targets for the sizes that have any."""


def of_scale(found: Sequence[Scale]) -> list[Row]:
    """Very many entities."""
    rows: list[Row] = []
    for one in found:
        bounds, of = _OF_SIZE.get(one.entities, {}), f"{one.entities:,} entities"
        least = one.limits
        measured: list[tuple[str, str, float | None, str]] = [
            ("load_turtle", f"load of {of}, Turtle", one.load_turtle_s, "s"),
            ("load_json", f"load of {of}, JSON", one.load_json_s, "s"),
            ("", f"CPU time of the knowledge base for a load, {of}", one.cpu_of_load_s["kb_node"], "s"),
            ("", f"limit of a load, {of}: Oxigraph alone reads the Turtle, CPU time", least.turtle_s, "s"),
            ("", f"limit: msgspec alone reads the JSON, {of}, CPU time", least.json_s, "s"),
            ("", f"limit: the entities in messages, there and back, {of}, CPU time", least.messages_s, "s"),
            ("", f"limit: zlib alone compresses the commit, {of}, CPU time", least.compress_s, "s"),
            ("", f"limit: the disk alone, {of}", least.disk_s, "s"),
            ("", f"memory of all processes after it, {of}", one.memory_loaded_mb / 1e3, "GB"),
            ("memory_gb", f"the same with SPARQL's store, {of}", one.memory_queried_mb / 1e3, "GB"),
            ("first_sparql", f"first SPARQL after a load, {of}", one.first_sparql_after_load_s, "s"),
            ("start", f"start until get answers, {of}", one.start_s, "s"),
            ("", f"CPU time of the knowledge base for a start, {of}", one.cpu_of_start_s["kb_node"], "s"),
            ("first_sparql", f"first SPARQL after a start, {of}", one.first_sparql_s, "s"),
            ("sparql", f"later SPARQL by the client, {of}", one.sparql_s, "s"),
            ("sparql", f"later SPARQL by the command line, {of}", one.sparql_by_command_line_s, "s"),
            ("list", f"list of one class in a hundred, {of}", one.list_class_s, "s"),
            ("check", f"check from nothing, {of}", one.check_s, "s"),
            ("", f"add over Zenoh right after a start, {of}, p50", one.early_add_ms, "ms"),
            ("", f"add over Zenoh, {of}, p50", one.add_ms, "ms"),
            ("", f"move over Zenoh, {of}, p50", one.update_ms, "ms"),
        ]
        for key, what, value, unit in measured:
            if value is not None:
                rows.append(Row(what, value, unit, *bounds.get(key, (None, None))))
    first, last = found[0], found[-1]
    if last is not first:
        growth = last.add_ms / first.add_ms
        what = f"add over Zenoh, {last.entities:,} against {first.entities:,}"
        rows.append(Row(what, growth, "times", 1.2, 1.0))
    return rows


def _pair(what: str, figures: Figures, reach: Bounds, aim: Bounds) -> list[Row]:
    """Median and 99th percentile."""
    return [
        Row(f"{what}, {name}", figures[f"{name}_ms"], "ms", reach[i], aim[i])
        for i, name in enumerate(("p50", "p99"))
    ]
