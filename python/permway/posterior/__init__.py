"""One posterior over amendments of a model: its likelihood, one fit, one search, and what follows from them."""
