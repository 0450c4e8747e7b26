"""What `make test` and `make test-flaky` do with pytest: run it in parts, and run tests again."""
