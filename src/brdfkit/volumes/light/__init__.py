"""Light in volumes: media, emission, surfaces, and the bounds that tracking needs."""
