"""Language processing: commands, noun phrases and generated texts; words, nouns and phrases are shared."""
