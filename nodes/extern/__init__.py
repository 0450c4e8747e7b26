"""What a person or an outside program touches: the command line, the client, the zenoh-cli codecs."""
