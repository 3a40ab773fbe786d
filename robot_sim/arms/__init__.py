"""The three papers' arms: D-H tables with limits, and their URDFs written from the same numbers."""
