"""The panels of the page. Each has a function that draws it."""
