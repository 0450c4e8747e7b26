"""The report of `semmap tbox check` about an ontology."""

from __future__ import annotations

from msgspec import Struct


class Unsatisfiable(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A class that cannot have instances, and the reason."""

    iri: str
    why: str


class Quickness(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Measured durations on this machine."""

    load_s: float
    """Loading the triples into a reasoner that is ready for changes, processor time [s]."""
    add_p50_ms: float | None
    """Adding a typical individual and checking the result, median [ms]; None if none could be added."""
    not_incremental: str = ""
    """The reason why every change is computed from scratch; empty if reasoning is incremental."""


class TBoxReport(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A report about an ontology with its imports, as a TBox for semmap."""

    files: tuple[str, ...]
    """The given files, followed by the imported ones."""
    ontologies: dict[str, str]
    """IRI of an ontology to its version IRI, which can be empty."""
    imports: dict[str, str]
    """Imported IRI to the file that was found for it."""
    missing: tuple[str, ...]
    """The imports that were not found."""
    triples: int
    classes: int
    spatial_classes: int | None
    """The number of classes of physical things; None if it cannot be determined."""
    spatial_candidate: str = ""
    """If no class is spatial: the class with the most subclasses, a candidate for a spatial root."""
    object_properties: int
    data_properties: int
    annotation_properties: int
    individuals: int
    outside_rl: dict[str, int]
    """Kind of axiom outside OWL 2 RL to its count; such axioms have no effect beyond OWL 2 RL."""
    inert: dict[str, int] = {}
    """Kind of statement that is stored but not evaluated, such as `SWRL rule (disabled)`, to its count."""
    left_out: tuple[str, ...] = ()
    """Notes on statements of named graphs, which are not part of the TBox, with their files."""
    undeclared: tuple[str, ...] = ()
    """IRIs of classes and properties that SWRL rules use and nothing declares."""
    inconsistent: str = ""
    """The reason why the ontology is inconsistent; empty if it is consistent."""
    unsatisfiable: tuple[Unsatisfiable, ...] = ()
    untried: int = 0
    """The number of classes that were not tested because of the time limit."""
    ambiguous: dict[str, dict[str, str]] = {}
    """Local name that several classes share, to their prefixed names (`soma:Joint`) with IRIs."""
    quickness: Quickness | None = None
    """None for an inconsistent ontology."""

    @property
    def is_sound(self) -> bool:
        """Whether the ontology is consistent and every class can have instances."""
        return not self.inconsistent and not self.unsatisfiable
