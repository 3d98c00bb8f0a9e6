"""The 3-D FE model beside the beam models: the plan of one case, its answers and its files."""
