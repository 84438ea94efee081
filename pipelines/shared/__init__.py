"""What all stages share: config, run trees, storage, freshness, pages, progress."""
