"""The panels of the page: one file each, and in it one function that draws it into where it is called."""
