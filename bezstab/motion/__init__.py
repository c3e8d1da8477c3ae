"""What the feedback does to the motion itself: the third map."""
