"""The objects of `import impactlab as il` beside the functions behind the commands."""
