import pytest

from semmap.nodes.kb_node.documents import text_encoding

XML = "<?xml version='1.0' encoding='{}'?>\n<a>caffè</a>"


@pytest.mark.parametrize(
    ("encoding", "declared"),
    [
        ("iso-8859-1", "ISO-8859-1"),
        ("cp1252", "windows-1252"),
        ("utf-8", "UTF-8"),
        ("utf-8-sig", "UTF-8"),
        ("utf-16", "UTF-16"),
        ("utf-16-le", "UTF-16"),  # without a byte order mark
        ("utf-16-be", "UTF-16"),
        ("utf-32", "UTF-32"),
    ],
)
def test_xml_in_any_encoding_becomes_utf_8(encoding, declared):
    converted = text_encoding.to_utf8(XML.format(declared).encode(encoding)).decode()
    assert converted.replace('"UTF-8"', "'UTF-8'") == XML.format("UTF-8")


def test_text_with_a_byte_order_mark_becomes_utf_8():
    for encoding in ("utf-8-sig", "utf-16", "utf-32"):
        assert text_encoding.to_utf8("# caffè\n".encode(encoding)).decode() == "# caffè\n"


def test_only_wide_text_needs_a_conversion():
    for encoding in ("utf-16", "utf-16-le", "utf-16-be", "utf-32"):
        assert text_encoding.is_wide("<a>".encode(encoding))
    assert text_encoding.is_wide("è".encode("utf-16"))
    assert not text_encoding.is_wide(XML.format("latin-1").encode("latin-1"))


@pytest.mark.parametrize(
    ("content", "text"),
    [
        (b"ab\ncaff\xe8", r"it is not UTF-8 text \(line 2\); save it as UTF-8"),
        ("a\nb\n".encode("utf-16") + b"x", r"it is not UTF-16-LE text \(line 3\)"),
        (XML.format("koi9").encode(), "unknown encoding 'koi9'; save it as UTF-8"),
        (XML.format("punycode").encode(), "unknown encoding 'punycode'"),
        (XML.format("UTF-16").encode(), "it declares the encoding UTF-16, but it is not in UTF-16"),
        (XML.format("ascii").encode(), r"it is not ASCII text \(line 2\)"),
    ],
)
def test_text_in_another_encoding_is_rejected_with_its_line(content, text):
    with pytest.raises(ValueError, match=text):
        text_encoding.to_utf8(content)
