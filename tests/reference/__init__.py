"""Independent answers: other routes to what bezstab computes."""
