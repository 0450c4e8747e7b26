"""An independent consistency check with owlrl, in a separate process."""
