"""The cost of ordinary tasks for an agent with the tools of `semmap mcp`: calls, and characters read."""
