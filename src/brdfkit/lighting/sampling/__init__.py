"""How emitters draw directions from an environment map."""
