"""What a scene may ask for beside positions."""
