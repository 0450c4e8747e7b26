"""Learning to understand commands: the corpus, examples of our own, and what is learnt from both."""
