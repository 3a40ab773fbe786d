"""Benchmarks: public API only, percentiles, side by side with what a user would pick instead."""
