"""What `semmap tbox check` finds out about an ontology."""

from __future__ import annotations

from msgspec import Struct


class Unsatisfiable(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A class of which nothing can be, and why."""

    iri: str
    why: str


class Quickness(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """How long it takes, on the machine and at the moment of asking."""

    load_s: float
    """From the triples to a reasoner that is ready for changes, in the processor's time [s]."""
    add_p50_ms: float | None
    """To add a typical individual and check the result, median [ms]; None where none could be added."""
    not_incremental: str = ""
    """Why every change is worked out from nothing; empty where it is not."""


class TBoxReport(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """An ontology with its imports, as semmap would take it for its TBox."""

    files: tuple[str, ...]
    """Those that were named, then those that they import."""
    ontologies: dict[str, str]
    """IRI of an ontology to that of its version, which may be empty."""
    imports: dict[str, str]
    """Import to the file that was found for it."""
    missing: tuple[str, ...]
    """The imports that were not found."""
    triples: int
    classes: int
    spatial_classes: int | None
    """How many of the classes are of things in space; None where that cannot be told."""
    spatial_candidate: str = ""
    """If no class is of things in space: the class above most others, as a candidate for a spatial root."""
    object_properties: int
    data_properties: int
    annotation_properties: int
    individuals: int
    outside_rl: dict[str, int]
    """Kind of axiom outside OWL 2 RL to how many there are; what they say beyond it has no effect."""
    inconsistent: str = ""
    """Why the ontology contradicts itself; empty where it does not."""
    unsatisfiable: tuple[Unsatisfiable, ...] = ()
    untried: int = 0
    """How many classes were not tried, because it takes too long."""
    ambiguous: dict[str, dict[str, str]] = {}
    """Local name that several classes share, to the names that tell them apart (`soma:Joint`), with IRIs."""
    quickness: Quickness | None = None
    """None for an ontology that contradicts itself."""

    @property
    def is_sound(self) -> bool:
        """Can there be something of every class?"""
        return not self.inconsistent and not self.unsatisfiable
