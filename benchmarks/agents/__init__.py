"""What an agent needs to do ordinary tasks with the tools of `semmap mcp`: calls, and characters to read."""
