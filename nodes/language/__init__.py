"""Understanding what people say about a map: words, phrases, frames and what they refer to. Pure, without a network."""
