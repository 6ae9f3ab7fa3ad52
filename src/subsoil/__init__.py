"""Adaptive soil-compaction surveying."""
