"""The stages: each reads files, calls hybridid, writes files. They meet through files alone."""
