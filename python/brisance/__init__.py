"""Reading and showing the results of Brisance."""
