"""What a volume holds: values, histograms, slices; as text and pictures."""
