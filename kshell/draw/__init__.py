"""Pictures of scenes and results."""
