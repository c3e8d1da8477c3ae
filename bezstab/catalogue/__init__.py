"""What other engines call the feedback: the command engines."""
