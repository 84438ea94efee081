"""What is fitted and what judges: horizons, and the tests of what they say."""
