"""Training and evaluation: rendered data sets, the forest's trainer, what is fitted on validation, figures."""
