"""Results of a run of comparisons for continuous integration: test results, summaries, baselines."""
