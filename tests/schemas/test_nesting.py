"""A file that is nested too deeply is rejected before a parser reads it."""

from contextlib import suppress

import pytest

from semmap.schemas.nesting import LIMIT, TooDeep, require_shallow, require_shallow_xml


def turtle_nodes(levels):
    return f"<a:a> <a:p> {'[ <a:p> ' * levels}1{' ]' * levels} ."


def turtle_lists(levels):
    return f"<a:a> <a:p> {'( ' * levels}{')' * levels} ."


def turtle_triples(levels):
    return f"{'<< ' * levels}<a:a> <a:p> 1{' >> <a:p> 1' * levels} ."


def functional(levels):
    return f"{'ObjectComplementOf(' * levels}<http://o#B>{')' * levels}"


def manchester(levels):
    return f"Class: <http://o#A>\n SubClassOf: {'not (' * levels}<http://o#B>{')' * levels}"


def json(levels):
    return '{"a": ' * (levels // 2) + "[" * (levels - levels // 2)


BRACKETS = [
    ("turtle", turtle_nodes),
    ("turtle", turtle_lists),
    ("turtle", turtle_triples),
    ("functional", functional),
    ("manchester", manchester),
    ("json", json),
]


@pytest.mark.parametrize(("syntax", "write"), BRACKETS)
def test_brackets_are_limited(syntax, write):
    require_shallow(write(LIMIT).encode(), syntax)
    for levels in (LIMIT + 1, 60_000):
        with pytest.raises(TooDeep, match=rf"nested deeper than {LIMIT} levels \(line \d"):
            require_shallow(b"\n" + write(levels).encode(), syntax)


@pytest.mark.parametrize(("syntax", "write"), BRACKETS)
def test_levels_are_counted_and_not_brackets(syntax, write):
    closed = write(20) + ("" if syntax != "json" else "]" * 10 + "}" * 10)
    require_shallow("\n".join([closed] * 50).encode(), syntax)


OPEN = "[(" * LIMIT


@pytest.mark.parametrize(
    ("syntax", "text"),
    [
        ("turtle", f'"{OPEN}"'),
        ("turtle", f"'{OPEN}'"),
        ("turtle", f'"""{OPEN}" ""\\"""{OPEN}\n{OPEN}"""'),
        ("turtle", f"'''{OPEN}' ''{OPEN}\n'''"),
        ("turtle", f'"\\"{OPEN}"'),
        ("turtle", f"<http://o#{OPEN}>"),
        ("turtle", f"# it's {OPEN}\n"),
        ("turtle", "a:" + "\\(" * (LIMIT + 1)),
        ("functional", f'"\\"{OPEN}\n{OPEN}"'),
        ("functional", f"<http://o#{OPEN}>"),
        ("functional", f'# " {OPEN}\n'),
        ("manchester", f'"{OPEN}"'),
        ("json", f'"\\"{OPEN}"'),
    ],
)
def test_brackets_in_texts_iris_and_comments_do_not_count(syntax, text):
    require_shallow(text.encode(), syntax)
    with pytest.raises(TooDeep, match=rf"\(line {1 + text.count(chr(10))}\)"):
        require_shallow(f"{text} {OPEN}".encode(), syntax)


@pytest.mark.parametrize("begun", ['"', "'", '"""', "'''", '\\"', "<", "<a", '"""\\"'])
@pytest.mark.parametrize("syntax", ["turtle", "functional", "json"])
def test_the_time_is_proportional_to_the_size_of_texts_without_an_end(syntax, begun):
    with suppress(TooDeep):
        require_shallow((begun * 200_000 + ")[" * LIMIT).encode(), syntax)


def xml(levels):
    return "<a>" * levels + "</a>" * levels


def test_xml_elements_are_limited():
    require_shallow_xml(f"<!-- {xml(300)} -->{xml(LIMIT)}".encode())
    for levels in (LIMIT + 1, 60_000):
        with pytest.raises(TooDeep, match=r"\(line 2\)"):
            require_shallow_xml(b"\n" + xml(levels).encode())


def entities(levels):
    declared = "".join(f'<!ENTITY e{n} "&e{n - 1};">' for n in range(1, levels + 1))
    return f'<!DOCTYPE a [<!ENTITY e0 "text">{declared}]><a b="&e{levels};">&e{levels};</a>'


def test_xml_entities_within_entities_are_limited():
    require_shallow_xml(entities(LIMIT).encode())
    for levels in (LIMIT + 1, 200_000):
        with pytest.raises(TooDeep):
            require_shallow_xml(entities(levels).encode())


def test_xml_entities_cannot_grow_without_limit():
    laughs = "".join(f'<!ENTITY e{n} "{f"&e{n - 1};" * 10}">' for n in range(1, 10))
    with pytest.raises(ValueError, match="amplification"):
        require_shallow_xml(f'<!DOCTYPE a [<!ENTITY e0 "lol">{laughs}]><a>&e9;</a>'.encode())


@pytest.mark.parametrize(
    "text", ["<a>", "<a></b>", '<!DOCTYPE a [<!ENTITY e SYSTEM "file:///x">]><a>&e;</a>']
)
def test_other_invalid_xml_is_rejected(text):
    with pytest.raises(ValueError, match=r"tag|no element|external"):
        require_shallow_xml(text.encode())
