"""Contact of matched surface nodes without friction, by impulses: no penalty stiffness."""
