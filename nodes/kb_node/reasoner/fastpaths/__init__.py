"""Fast paths for changes whose consequences are known from similar changes. They do not affect results."""
