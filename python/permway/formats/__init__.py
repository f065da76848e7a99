"""Files of models: TOML in, a checked model out, and back."""
