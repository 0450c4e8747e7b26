"""Which client may run which command: certificates, roles, operator approval, and authority over facts."""
