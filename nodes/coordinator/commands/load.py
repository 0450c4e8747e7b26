"""Handler of load: a document in an RDF syntax, a scene, a HuRIC map, or another TBox."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import Final

from msgspec import structs

from semmap.nodes.coordinator.access.authority import require_authority, require_operator
from semmap.nodes.coordinator.commands import transactions
from semmap.nodes.coordinator.commands.commit import (
    apply,
    apply_with_classes,
    commit,
    make_reply,
    reload_map,
)
from semmap.nodes.coordinator.commands.map_view import MapView
from semmap.nodes.coordinator.commands.placement import Named, place_described, placing_of
from semmap.nodes.coordinator.commands.plausibility import require_same_nature
from semmap.nodes.coordinator.commands.registration import handles
from semmap.nodes.coordinator.files import huric
from semmap.nodes.coordinator.files.content import kind_of
from semmap.nodes.coordinator.free_names import FreeNames
from semmap.nodes.coordinator.kb_coroutines import KbCoroutine, ask
from semmap.nodes.runtime import memory
from semmap.nodes.runtime.class_names import AmbiguousClass, ClassNames
from semmap.schemas import changes, errors, scene_files, wording
from semmap.schemas.bridge import LoadDocument, LoadTBox
from semmap.schemas.commands import Load
from semmap.schemas.commits import Edit, Effects, NewEntity, Transaction
from semmap.schemas.entities import ClassInfo, Entity
from semmap.schemas.packing import unpacked
from semmap.schemas.replies import Changed
from semmap.schemas.scene_files import Described

PART: Final = 10_000
"""Number of entities in each part of a scene that is loaded in parts."""

READERS: Mapping[str, Callable[[bytes, str], tuple[Described, ...]]] = {
    "scene": lambda content, filename: scene_files.read(content, filename).entities,
    "huric": huric.read,
}


@handles(Load)
def load(view: MapView, command: Load) -> KbCoroutine[Changed]:
    """Add the entities of a file to the map."""
    if command.source == "operator":
        command = structs.replace(command, source="file")
    if command.parts and (command.replace or command.tbox):
        how = "--tbox" if command.tbox else "--replace"
        raise errors.BadRequest(f"{how} makes one commit; load it without --parts")
    if command.tbox_from_abox:
        _require_declarations(command)
    if command.parts and command.dry_run:
        raise errors.BadRequest("a dry run covers one commit; try it without --parts")
    if command.tbox:
        return (yield from _load_tbox(view, command))
    if command.spatial_root:
        raise errors.BadRequest("--spatial-root is for a TBox: add --tbox")
    if command.add_only and command.replace:
        raise errors.BadRequest("give either --add-only or --replace")
    if command.extend:
        raise errors.BadRequest("--extend applies to TBoxes only; add --tbox")
    if command.replace:
        require_authority(command, view.entities.values())
    kind = kind_of(command.content, command.filename)
    if kind == "abox":
        return (yield from _load_document(view, command))
    if command.urdf:
        raise errors.BadRequest("--urdf applies to maps in RDF or OWL only")
    if command.tbox_from_abox:
        raise errors.BadRequest("--tbox-from-abox applies to maps in RDF or OWL only")
    if command.graph:
        raise errors.BadRequest("--graph applies to TriG, N-Quads and JSON-LD files only")
    content = unpacked(command.content, command.filename)
    return (yield from _load_described(view, command, READERS[kind](content, command.filename)))


def _load_described(view: MapView, command: Load, described: Iterable[Described]) -> KbCoroutine[Changed]:
    there: Mapping[str, Entity] = {} if command.replace else view.entities
    with memory.uncollected():
        known, skipped, notes = _sort_out(view.classes, described, skip_unknown=command.skip_unknown)
        items = _name_all(known, there, command.filename or "the file")
    if any(placing_of(item) is not None for _, item, _ in items):
        items, shut = yield from place_described(items, there, replace=command.replace)
        notes = (*notes, *shut)
    with memory.uncollected():
        new: list[NewEntity] = []
        edits: list[Edit] = []
        names = {name: there.get(name) for name, _, _ in items}
        for name, item, found in items:
            if (was := names[name]) is None:
                new.append(transactions.new_entity(name, found, item))
            elif command.add_only:
                raise errors.NameTaken(
                    f"the name '{name}' is already taken; to replace its pose, size and labels, load the file"
                    " without --add-only"
                )
            else:
                require_same_nature(was, found, force=False)
                edits.append(transactions.edit_entity(was, found, item))
        leaving = tuple(view.entities) if command.replace else ()
        change = transactions.build(command, f"load {command.filename}", remove=leaving, edit=edits, add=new)
    if command.parts:
        made = yield from _commit_parts(view, change)
    else:
        made = yield from commit(view, change)
    if made is not None and made.trial is not None:
        changed = {entity.name: entity for entity in made.changed}
    else:
        changed = {name: view.entities[name] for name in names if name in view.entities}
    counts = changes.count_kinds(
        (was, now if now != was else None) for name, was in names.items() for now in (changed.get(name),)
    )
    return _loaded(command, made, tuple(names), skipped, notes, counts)


def _name_all(
    known: Iterable[tuple[Described, ClassInfo]], there: Mapping[str, Entity], file: str
) -> list[Named]:
    """Return the entities of a scene with their names. Raises NameTaken if one is given twice."""
    taken_names, free = set(there), FreeNames()
    named: dict[str, Named] = {}
    for item, found in known:
        name = item.name or free.name(found.name, taken_names)
        if name in named:
            raise errors.NameTaken(f"the name '{name}' is given twice in {file}")
        taken_names.add(name)
        named[name] = (name, item, found)
    return list(named.values())


def _commit_parts(view: MapView, whole: Transaction) -> KbCoroutine[Effects | None]:
    """Commit a scene in parts and return the last commit; the last part has the command's id."""
    last: Effects | None = None
    done: list[int] = []
    starts = range(0, max(len(whole.add), len(whole.edit)), PART)
    for number, start in enumerate(starts, start=1):
        part = structs.replace(
            whole,
            id=whole.id if number == len(starts) else f"{whole.id}/{number}",
            reason=f"{whole.reason}, part {number} of {len(starts)}",
            edit=whole.edit[start : start + PART],
            add=whole.add[start : start + PART],
        )
        try:
            made = yield from commit(view, part)
        except errors.SemmapError as error:
            raise errors.in_part(error, done, number, len(starts)) from None
        if made is not None:
            last = made
            done.append(made.seq)
    return last


def _load_document(view: MapView, command: Load) -> KbCoroutine[Changed]:
    document = LoadDocument(
        id=command.id,
        source=command.source,
        agent=command.agent,
        reason=command.reason or f"load {command.filename}",
        content=command.content,
        filename=command.filename,
        replace=command.replace,
        add_only=command.add_only,
        graph=command.graph,
        urdf=command.urdf,
        skip_unknown=command.skip_unknown,
        strict=command.strict,
        parts=command.parts,
        tbox_from_abox=command.tbox_from_abox,
        dry_run=command.dry_run,
        told=not command.parts,
    )
    loaded = yield from ask(document)
    if loaded.commit is not None and loaded.commit.tbox:
        yield from apply_with_classes(view, loaded.commit)
    elif loaded.parts == 1:
        yield from apply(view, loaded.commit)
    elif loaded.commit is not None:
        yield from reload_map(view)
    return _loaded(command, loaded.commit, loaded.names, loaded.skipped, loaded.notes, loaded.counts)


def _require_declarations(command: Load) -> None:
    """Raise BadRequest or Refused if a load cannot add the declarations of a map to the TBox."""
    if command.tbox:
        raise errors.BadRequest("--tbox-from-abox applies to maps only; to add a file to the TBox: --extend")
    if command.parts:
        raise errors.BadRequest("--tbox-from-abox makes one commit; load it without --parts")
    require_operator(command, "extend the TBox")


def _load_tbox(view: MapView, command: Load) -> KbCoroutine[Changed]:
    if command.replace or command.add_only or command.skip_unknown or command.strict:
        raise errors.BadRequest(
            "--replace, --add-only, --skip-unknown and --strict apply to maps only: a TBox always replaces"
            " the present one (or extends it, with --extend) and leaves the map as it is"
        )
    if command.urdf:
        raise errors.BadRequest("--urdf applies to maps only; load the TBox without it")
    require_operator(command, "extend the TBox" if command.extend else "replace the TBox")
    file = command.filename or "the file"
    order = LoadTBox(
        id=command.id,
        source=command.source,
        agent=command.agent,
        reason=command.reason or f"{'extend' if command.extend else 'load'} the TBox {command.filename}",
        content=command.content,
        filename=command.filename,
        spatial_root=command.spatial_root,
        extend=command.extend,
        graph=command.graph,
        dry_run=command.dry_run,
    )
    loaded = yield from ask(order)
    if (commit := loaded.commit) is None:
        text = f"unchanged: the TBox {'already contains' if command.extend else 'is already that of'} {file}"
        return Changed(commit=None, text=text, notes=loaded.notes)
    before = len(view.classes.by_name)
    yield from apply_with_classes(view, commit)
    count = len(view.classes.by_name)
    text = f"{count} classes from {file}"
    if command.extend:
        text = f"the TBox extended by {file}: {_classes(count - before)} added, {count} in total"
    if commit.trial is not None:
        text = f"the TBox of {file} replaces the present one"
        if command.extend:
            text = f"the TBox extended by {file}"
    return make_reply(commit, text, names=commit.names, notes=loaded.notes)


def _classes(count: int) -> str:
    return "1 class" if count == 1 else f"{count} classes"


def _sort_out(
    classes: ClassNames, described: Iterable[Described], *, skip_unknown: bool
) -> tuple[list[tuple[Described, ClassInfo]], tuple[str, ...], tuple[str, ...]]:
    """Return the entities of known classes, a note on each of the others, and how class names were read."""
    known: list[tuple[Described, ClassInfo]] = []
    unknown: dict[str, list[str]] = {}
    notes: dict[str, None] = {}
    for i, item in enumerate(described, start=1):
        try:
            found = classes.spatial(item.class_)
        except AmbiguousClass:
            raise
        except errors.UnknownClass:
            unknown.setdefault(item.class_, []).append(item.name or f"entity {i}")
            continue
        known.append((item, found))
        notes.update(dict.fromkeys(classes.note(item.class_, found)))
    if unknown and not skip_unknown:
        raise classes.unknown(unknown)
    skipped = tuple(f"{name} (unknown class '{c}')" for c, names in unknown.items() for name in names)
    return known, skipped, tuple(notes)


def _loaded(
    command: Load,
    commit: Effects | None,
    names: tuple[str, ...],
    skipped: tuple[str, ...],
    notes: tuple[str, ...],
    counts: Mapping[str, int],
) -> Changed:
    """Return the reply to a load; `counts` are the numbers of entities by what has changed."""
    file, total = command.filename or "the file", wording.entities(sum(counts.values()))
    text = f"loaded {total} from {file}"
    if commit is None:
        text = f"{file} changes nothing in the map"
    if counts.keys() - {"new"}:
        text += f": {changes.counts_in_words(counts)}"
    if skipped:
        text += f", left out {len(skipped)}"
    return make_reply(commit, text, names=names, skipped=skipped, notes=notes)
