"""What reports say of 3-D runs: on the page of a study, and of one run on its own."""
