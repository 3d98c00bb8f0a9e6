"""What `import impactlab as il` adds to the functions behind the commands."""
