"""The 3-D FE model beside the beam models: one case, what it will cost, and what they say of it."""
