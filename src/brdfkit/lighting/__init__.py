"""Light from environments: how maps are cut, sampled and filtered; spherical Gaussians."""
