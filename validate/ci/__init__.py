"""What a run of comparisons leaves for services that decide on it: test results, summaries, baselines."""
