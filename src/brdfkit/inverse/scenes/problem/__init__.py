"""What `refine` minimises: parameters of a scene, its views and their targets."""
