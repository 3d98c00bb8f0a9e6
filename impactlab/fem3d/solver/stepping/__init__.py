"""Central differences in time: forces of the elements, motion of the nodes, contact."""
