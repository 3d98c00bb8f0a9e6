"""An explicit 3-D finite-element model of the impact, independent of the beam models."""
