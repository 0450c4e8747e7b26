"""What people say about a map and what is said of it: words, nouns and phrases, which all parts share."""
