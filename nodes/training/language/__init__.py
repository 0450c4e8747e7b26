"""Training of command understanding: the corpus, generated examples, and the taggers."""
