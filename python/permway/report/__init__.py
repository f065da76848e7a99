"""Pictures of answers, and the report on the paper."""
