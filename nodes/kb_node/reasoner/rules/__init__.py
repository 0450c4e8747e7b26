"""The OWL 2 RL/RDF rules as a table, and the closure of a graph under them."""
