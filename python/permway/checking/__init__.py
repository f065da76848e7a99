"""What is wrong with a campaign before any physics: blunders of units, signs and labels, each with its remedy."""
