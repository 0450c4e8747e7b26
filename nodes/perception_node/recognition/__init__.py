"""What a thing is, and where its hidden sides are: features, what was learnt, and the vote."""
