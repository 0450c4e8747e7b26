"""Implementation of `make test` and `make test-flaky`: run pytest in parts, and run tests again."""
