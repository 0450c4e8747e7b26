"""Fast paths for changes that look like others whose consequences are known; none changes an answer."""
