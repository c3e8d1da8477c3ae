"""What others call the feedback: engines' own parameters, and a drive's gains, in alpha_hat and beta_hat.

    values in an engine's words -> what the engine makes of them -> (alpha_hat, beta_hat) and the method it steps with
    (alpha_hat, beta_hat) -> a line to paste

What an engine has no words for is refused, not guessed.
"""
