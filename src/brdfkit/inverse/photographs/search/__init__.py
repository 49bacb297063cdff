"""Searches the maps that explain the photographs."""
