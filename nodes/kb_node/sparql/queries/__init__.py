"""What is asked: which queries are allowed, which commits may touch their rows, and how they are answered."""
