"""Variograms: models, empirical estimates and fits."""
