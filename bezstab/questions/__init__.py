"""What several questions share: the motion that they are about, methods and goals left open, energy, runs, chains."""
