"""From looks to the map: which observation is which thing, and what the map is told."""
