"""Reads large Turtle and N-Triples files as programs write them, five times as fast as Oxigraph.

A part of the document with one full triple after the other, without spaces in literals, is split at spaces
and read in columns. Other parts are read line by line. Each distinct word is parsed once, by Oxigraph if it
is unusual, so the result is the same as Oxigraph's. Documents with other content, such as lists, multi-line
literals or errors, are not read here.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from typing import Final

import pyoxigraph

from semmap.nodes.kb_node.documents.plain_words import plain_terms
from semmap.ontology import vocabulary as v
from semmap.schemas.explanations import Term, Triple

_PIECE: Final = 1 << 17
"""Bytes whose data fits into the processor's cache."""
_REMEMBERED: Final = 200_000
"""Largest number of words that are cached."""
_WORD = (
    r'<[^\s<>"]*>|"(?:[^"\\\n\r]|\\.)*"(?:\^\^(?:<[^\s<>"]*>|[^\s<>"\',;]+)|@[A-Za-z0-9-]+)?|[^\s<>"\',;]+'
)
_WORDS = re.compile(rf"(?:#.*|{_WORD}|[;,]|[^ \t])")
_TAIL = re.compile(rf"({_WORD})[ \t]*([.;,])[ \t]*")
"""An object and its separator."""
_PREFIX = re.compile(r"@prefix\s+([A-Za-z0-9_-]*):\s*<([^\s<>]*)>\s*\.\s*")
_DECLARED = re.compile(rb"(?:(?:@prefix .*|#.*|)\r?\n)+")
"""The lines at the beginning of a document."""
_HIERARCHY = r"[a-z]+://[A-Za-z0-9.-]+(?:/(?:[A-Za-z0-9_~-][A-Za-z0-9._~-]*)?)"
"""The beginning of an absolute IRI that is not changed by normalisation."""
_IRI = re.compile(rf"<{_HIERARCHY}*(?:#[A-Za-z0-9._~/-]*)?>")
_NAMESPACE = re.compile(rf"{_HIERARCHY}+#?")
_PREFIXED = re.compile(r"([A-Za-z][A-Za-z0-9_-]*|):([A-Za-z0-9_][A-Za-z0-9_-]*)")
_LITERAL = re.compile(r'("[ !#-\[\]-~]*")(?:\^\^(\S+))?')
_NUMBER = re.compile(r"[+-]?[0-9]*(\.?)[0-9]+")
_OF_XSD: Final = f"<{v.XSD}"
_STRING, _INTEGER, _DECIMAL = (v.iri(v.XSD + kind) for kind in ("string", "integer", "decimal"))
_SUBJECT, _PREDICATE, _OBJECT, _SEPARATOR = range(4)
_AFTER: Final = {".": _SUBJECT, ";": _PREDICATE, ",": _OBJECT}
_ODD_SPACES: Final = tuple(c for c in map(chr, range(0x3001)) if c.isspace() and c not in " \t\r\n")
"""Characters that Python treats as spaces and Turtle does not."""


class _NotPlain(Exception):
    """Raised if Oxigraph must read the whole document."""


class _Words(dict[str, Term]):
    """The terms of words. Raises _NotPlain for a word that is not valid there."""

    def __init__(self, look_up: Callable[[str], Term]) -> None:
        self._look_up = look_up

    def __missing__(self, word: str) -> Term:
        if len(self) >= _REMEMBERED:
            self.clear()
        term = self[word] = self._look_up(word)
        return term


def read(
    content: bytes, prefixes: dict[str, str], label_prefix: str, progress: Callable[[int], None]
) -> list[Triple] | None:
    """Return the triples in their order, with terms as Oxigraph writes them, or None if this reader cannot.

    `prefixes` are declared before the first triple. Blank nodes get `label_prefix`. `progress` receives the
    number of triples now and then.
    """
    reader = _Reader(prefixes, label_prefix)
    try:
        return reader.read(content, progress)
    except (_NotPlain, UnicodeDecodeError):
        return None
    finally:
        reader.forget()


class _Reader:
    """Reads one document. Equal terms are the same object, with few exceptions."""

    def __init__(self, prefixes: dict[str, str], label_prefix: str) -> None:
        self._prefixes = prefixes
        self._plain = {name: iri for name, iri in prefixes.items() if _NAMESPACE.fullmatch(iri)}
        self._head = "".join(f"@prefix {name}: <{iri}> .\n" for name, iri in prefixes.items())
        self._label_prefix = label_prefix
        self._shared: dict[Term, Term] = {}
        self._datatypes: dict[str, Term | None] = {}
        """Datatypes whose literals keep their text; None for others."""
        self._subjects = _Words(self._subject)
        self._predicates = _Words(self._predicate)
        self._tails = _Words(self._tail)
        self._known: dict[str, Term] = {}
        """The terms of words in parts that are read in columns."""
        self._terms: list[Term] = []
        """Subject, predicate, object, subject, ...; the triples made from them are adjacent in memory."""
        self._expects = _SUBJECT
        self._said: tuple[Term, Term] = ("", "")

    def read(self, content: bytes, progress: Callable[[int], None]) -> list[Triple]:
        for piece in _pieces(content):
            text = piece.decode()
            if not self._read_columns(text):
                self._read_lines(text.replace("\r\n", "\n").split("\n"))
            progress(len(self._terms) // 3)
        if self._expects != _SUBJECT:
            raise _NotPlain
        each = iter(self._terms)
        return list(zip(each, each, each, strict=True))

    def forget(self) -> None:
        """Clear the caches, because the reference cycle between words and reader may live long."""
        for words in (self._subjects, self._predicates, self._tails, self._known, self._shared):
            words.clear()
        self._terms = []

    def _read_columns(self, text: str) -> bool:
        """Read a part that consists of full triples without spaces; return False for any other."""
        words = text.split()
        subjects, predicates, objects, ends = (words[i::4] for i in range(4))
        if self._expects != _SUBJECT or len(words) % 4 or ends.count(".") != len(ends):
            return False
        if any(map(text.__contains__, _ODD_SPACES)):
            return False
        try:
            known = self._resolve_words({*subjects, *objects})
            subject_terms = list(map(known.__getitem__, subjects))
            if any(term[0] == '"' for term in set(subject_terms)):
                return False
            terms: list[Term] = [""] * (3 * len(ends))
            terms[::3] = subject_terms
            terms[1::3] = map(self._predicates.__getitem__, predicates)
            terms[2::3] = map(known.__getitem__, objects)
        except _NotPlain:
            return False
        self._terms += terms
        return True

    def _resolve_words(self, words: set[str]) -> dict[str, Term]:
        """Return the terms of words. Raises _NotPlain for an invalid word."""
        known = self._known
        if len(known) > _REMEMBERED:
            known = self._known = {word: known[word] for word in words & known.keys()}
        new = words.difference(known)
        known.update(plain_terms(new, self._plain, self._datatype))
        for word in new.difference(known):
            known[word] = self._term(word)
        return known

    def _read_lines(self, lines: list[str]) -> None:
        """Read lines: a triple or its end in one step, any other line word by word."""
        subjects, predicates, tails = self._subjects, self._predicates, self._tails
        add, expects, (subject, predicate) = self._terms.extend, self._expects, self._said
        for line in lines:
            try:
                if expects == _SUBJECT:
                    s, p, tail = line.split(" ", 2)
                    triple = subjects[s], predicates[p], tails[tail]
                    subject, predicate, _ = triple
                elif expects == _PREDICATE:
                    p, tail = line.lstrip(" \t").split(" ", 1)
                    _, predicate, _ = triple = subject, predicates[p], tails[tail]
                elif expects == _OBJECT:
                    tail = line.strip(" \t")
                    triple = subject, predicate, tails[tail]
                else:
                    raise _NotPlain
                after = _AFTER[tail[-1]]
            except (ValueError, KeyError, _NotPlain):
                self._expects, self._said = expects, (subject, predicate)
                self._read_words(line)
                expects, (subject, predicate) = self._expects, self._said
                continue
            add(triple)
            expects = after
        self._expects, self._said = expects, (subject, predicate)

    def _read_words(self, line: str) -> None:
        if self._expects == _SUBJECT and (declared := _PREFIX.fullmatch(line)) is not None:
            if self._prefixes.get(declared[1]) != declared[2]:
                raise _NotPlain
            return
        for word in _WORDS.findall(line):
            if word[0] == "#":
                continue
            subject, predicate = self._said
            if self._expects == _SUBJECT:
                self._said, self._expects = (self._subjects[word], ""), _PREDICATE
            elif self._expects == _PREDICATE and word in (".", ";") and predicate:
                self._expects = _AFTER[word]  # as in `:a :p 1 ; .`
            elif self._expects == _PREDICATE:
                self._said, self._expects = (subject, self._predicates[word]), _OBJECT
            elif self._expects == _OBJECT:
                self._terms += (subject, predicate, self._term(word))
                self._expects = _SEPARATOR
            elif word in _AFTER:
                self._expects = _AFTER[word]
            else:
                raise _NotPlain

    def _subject(self, word: str) -> Term:
        term = self._term(word)
        if term[0] == '"':
            raise _NotPlain
        return term

    def _predicate(self, word: str) -> Term:
        term = v.RDF_TYPE if word == "a" else self._term(word)
        if term[0] != "<":
            raise _NotPlain
        return term

    def _tail(self, text: str) -> Term:
        if text[-2:-1] == " " and (term := self._plain_term(text[:-2])) is not None:
            return self._shared.setdefault(term, term)
        found = _TAIL.fullmatch(text)
        if found is None:
            raise _NotPlain
        return self._term(found[1])

    def _term(self, word: str) -> Term:
        term = self._plain_term(word) or self._as_oxigraph_reads(word)
        return self._shared.setdefault(term, term)

    def _plain_term(self, word: str) -> Term | None:
        """Return the term of a common word, or None."""
        match word[:1]:
            case '"':
                found = _LITERAL.fullmatch(word)
                return None if found is None else self._plain_literal(word, *found.groups())
            case "<":
                return word if _IRI.fullmatch(word) else None
        if found := _PREFIXED.fullmatch(word):
            namespace = self._plain.get(found[1])
            return None if namespace is None else f"<{namespace}{found[2]}>"
        if found := _NUMBER.fullmatch(word):
            return f'"{word}"^^{_DECIMAL if found[1] else _INTEGER}'
        return None

    def _plain_literal(self, word: str, text: str, kind: str | None) -> Term | None:
        if kind is None:
            return word
        datatype = self._datatype(kind)
        return None if datatype is None else f"{text}^^{datatype}"

    def _datatype(self, kind: str) -> Term | None:
        """Return the datatype if its literals keep their text, or None."""
        if kind not in self._datatypes:
            datatype = self._plain_term(kind)
            is_plain = datatype is not None and datatype.startswith(_OF_XSD) and datatype != _STRING
            self._datatypes[kind] = datatype if is_plain else None
        return self._datatypes[kind]

    def _as_oxigraph_reads(self, word: str) -> Term:
        """Return the term of any other word. Raises _NotPlain for an invalid or unnamed term."""
        head = self._head if ":" in word else ""
        document = f"{head}<x:s> <x:p> {word} ."
        try:
            (quad,) = pyoxigraph.parse(document, pyoxigraph.RdfFormat.TURTLE, base_iri=v.ABOX)
        except (SyntaxError, ValueError):
            raise _NotPlain from None
        term = str(quad.object)
        if term[0] == "_" and word == term:
            return f"_:{self._label_prefix}{term[2:]}"
        if term[0] not in '<"' or term[:2] == "<<":
            raise _NotPlain
        return term


def _pieces(content: bytes) -> Iterator[bytes]:
    """Yield the content, cut at line ends: first the declarations, then the rest."""
    declared = _DECLARED.match(content)
    at = 0 if declared is None else declared.end()
    if at:
        yield content[:at]
    while at < len(content):
        end = content.find(b"\n", at + _PIECE) + 1 or len(content)
        yield content[at:end]
        at = end
