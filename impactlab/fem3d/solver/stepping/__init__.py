"""Central differences in time: forces from the elements, kicks on the nodes, contact between."""
