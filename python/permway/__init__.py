"""permway: how a train, its track and the viaduct below vibrate."""
