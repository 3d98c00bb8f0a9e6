"""The schema of study files: which keys they may hold, and how they are read and checked."""
