"""Studies of the source's figures with rendered people, through the tracker; each is one command."""
