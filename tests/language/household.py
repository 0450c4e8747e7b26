"""A small household to speak of."""

from semmap.nodes.language import lexicon
from semmap.nodes.language.understanding.grounding import Thing, scene
from semmap.nodes.training.language.household import household

LEXICON = lexicon.load()
THINGS = (
    Thing("kitchen1", "Kitchen", ("kitchen",), (8.0, 2.0, 0.0)),
    Thing("table1", "Dining_Table", ("kitchen table",), (8.2, 2.5, 0.0)),
    Thing("table2", "Table", ("side table",), (2.0, 2.5, 0.0)),
    Thing("fridge1", "Fridge", ("fridge",), (6.4, 0.4, 0.0)),
    Thing("bottle1", "Bottle", ("bottle",), (8.3, 2.5, 0.74)),
    Thing("book1", "Book", ("novel",), (8.0, 2.4, 0.74)),
    Thing("couch1", "Couch", (), (2.0, 6.0, 0.0)),
    Thing("robot1", "Robot", ("robot", "you"), None),
)


def there(things=THINGS):
    return scene(things, household(), LEXICON)
