"""What is asked of a line: its model, frequencies, forces, sensors and train, and the answer as a dataset."""
