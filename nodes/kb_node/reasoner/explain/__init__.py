"""Why something holds: reasons, a smallest set of asserted triples, and sentences."""
