"""English noun phrases: articles, plurals, numbers and lists."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Final

_IRREGULAR: Final = {
    "child": "children",
    "foot": "feet",
    "half": "halves",
    "knife": "knives",
    "leaf": "leaves",
    "life": "lives",
    "loaf": "loaves",
    "man": "men",
    "mouse": "mice",
    "person": "people",
    "potato": "potatoes",
    "scarf": "scarves",
    "shelf": "shelves",
    "thief": "thieves",
    "tomato": "tomatoes",
    "tooth": "teeth",
    "wife": "wives",
    "wolf": "wolves",
    "woman": "women",
}
_COMPOUNDED: Final = ("shelf", "knife", "leaf", "loaf")
"""Irregular also as the last part of a compound: bookshelf."""
_WITHOUT_ARTICLE: Final = frozenset(
    (
        *("air", "bread", "butter", "cheese", "chocolate", "clothing", "conditioning", "corn", "cutlery"),
        *(
            "detergent",
            "dishware",
            "equipment",
            "flatware",
            "flour",
            "food",
            "fruit",
            "furniture",
            "glassware",
        ),
        *("heating", "jam", "juice", "ketchup", "laundry", "luggage", "mayo", "meat", "milk", "money"),
        *("mustard", "oil", "paper", "pasta", "rice", "rubbish", "salt", "soap", "sugar", "tableware", "tea"),
        *("trash", "water", "wine", "wood", "wool"),
        *("biscuits", "blinds", "cereals", "cigarettes", "clothes", "glasses", "headphones", "jeans", "keys"),
        *("pants", "scissors", "shoes", "slippers", "stairs", "trousers"),
    )
)
"""Last words of mass nouns and of nouns that are always plural."""
_AS_CONSONANT: Final = re.compile(
    r"(?:eu|one\b|once|ubiq|uni(?!n|m)|us[aeiu]|ut[ei]|u\b|ur[aeio])", re.IGNORECASE
)
_AS_VOWEL: Final = re.compile(r"(?:heir|honest|hono|hour|[fhlmnrsx]\d*\b(?!\w)|[A-Z]*\b8)")
_NUMBERS: Final = ("no", "one")


def is_counted(noun: str) -> bool:
    """Return whether a noun takes an article ("a chair"), unlike milk, scissors and Anna."""
    return not noun.istitle() and noun.lower().rpartition(" ")[2] not in _WITHOUT_ARTICLE


def article(noun: str) -> str:
    """Return `a` or `an`, by the likely pronunciation of the word."""
    if _AS_VOWEL.match(noun):
        return "an"
    return "an" if noun[:1].lower() in "aeiou" and not _AS_CONSONANT.match(noun) else "a"


def plural(noun: str) -> str:
    """Return the plural of a noun phrase whose last word is its noun."""
    if not is_counted(noun):
        return noun
    before, space, word = noun.rpartition(" ")
    return before + space + _plural(word)


def _plural(word: str) -> str:
    lower = word.lower()
    if lower in _IRREGULAR:
        return word[0] + _IRREGULAR[lower][1:]
    if lower.endswith(_COMPOUNDED):
        return word[:-1] + "ves" if lower.endswith("f") else word[:-2] + "ves"
    if re.search(r"[^aeiou]y$", lower):
        return word[:-1] + "ies"
    if re.search(r"(?:s|x|z|ch|sh)$", lower):
        return word + "es"
    return word + "s"


def with_count(count: int, noun: str) -> str:
    """Return `a chair`, `4 chairs`, `milk` or `milk (2)`."""
    if not is_counted(noun):
        return noun if count == 1 else f"{noun} ({count})"
    return f"{article(noun)} {noun}" if count == 1 else f"{count} {plural(noun)}"


def with_number_word(count: int, noun: str) -> str:
    """Return `no chairs`, `one chair` or `4 chairs`."""
    return f"{_NUMBERS[count] if count < len(_NUMBERS) else count} {noun if count == 1 else plural(noun)}"


def is_plural(count: int, noun: str) -> bool:
    """Return whether the verb for this number of things is in the plural."""
    return count != 1 or (not is_counted(noun) and noun.endswith("s"))


def enumerate_nouns(parts: Sequence[str]) -> str:
    """Return an enumeration: `a cup, 2 plates and a spoon`."""
    return parts[0] if len(parts) == 1 else f"{', '.join(parts[:-1])} and {parts[-1]}" if parts else ""
