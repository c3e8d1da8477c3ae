"""Steps that vary: does every sequence of steps in a range let errors decay? Proven, refuted or not known."""
