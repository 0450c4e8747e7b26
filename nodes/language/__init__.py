"""Understanding what people say about a map: words, phrases, frames, entities."""
