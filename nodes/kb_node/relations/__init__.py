"""Where things are, in words: relations worked out from poses, sizes and shapes."""
