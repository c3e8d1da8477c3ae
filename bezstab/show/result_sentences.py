"""What results say in sentences, beside their rows: what feedback costs, where it is best, when errors grow."""

from bezstab.questions.motions import ReferenceMotion


def combined_words(motion: ReferenceMotion) -> str:
    """Return what combined errors are shares of."""
    return (
        "\nErrors of position and velocity are relative to the amplitudes of a motion's position and velocity, here "
        f"{motion.words}."
    )


def energy_words(motion: ReferenceMotion) -> str:
    """Return what growths of energy are shares of."""
    return (
        "\nGrowth is a share of the energy of a mass on a circle, in each revolution. Its rate varies by 30 % to both "
        f"sides. Here it is {motion.words}. A negative growth is a loss. In n revolutions it takes the "
        "motion off its course by 1.6 n² times as much of its amplitude."
    )
