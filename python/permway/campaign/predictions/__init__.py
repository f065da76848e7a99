"""What sensors should read, by the way in which a structure is made to move."""
