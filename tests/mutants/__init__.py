"""Changes the code of a node a little, and shows whether the node's own tests notice: `make mutants`."""
