"""The numbers of each texel that `svbrdf` searches, and how they become light."""
