"""List the objects that are not in the kitchen: python examples/shopping_list.py Milk Bread Tomato."""

from __future__ import annotations

import sys

import semmap


def shopping_list(client: semmap.Client, wanted: list[str], place: str = "kitchen") -> list[str]:
    """Return the classes without an instance in `place`; subclasses count (a Beer is a Drink)."""
    return [class_ for class_ in wanted if not client.list(class_, in_=place)]


def main() -> None:
    """Print the missing classes."""
    wanted = sys.argv[1:] or ["Milk", "Bread", "Tomato"]
    with semmap.connect(agent="shopping list") as client:
        try:
            missing = shopping_list(client, wanted)
        except semmap.UnknownClass as error:
            sys.exit(error.text)  # suggests similar class names
    print("buy:", ", ".join(missing) if missing else "nothing")


if __name__ == "__main__":
    main()
