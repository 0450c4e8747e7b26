"""Who has room where: obstacles, clearance, and bodies that come, go and settle."""
