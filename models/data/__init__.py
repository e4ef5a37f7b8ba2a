"""Instances and preferences to train on, and their labels."""
