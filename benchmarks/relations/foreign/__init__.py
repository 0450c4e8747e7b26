"""Relations in MJCF worlds that were not made for semmap, compared with physics."""
