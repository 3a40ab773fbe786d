"""The three papers' experiments, each one function that writes tables, plots and the motion into a folder."""
