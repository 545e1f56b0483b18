"""An independent truth: the lengthened Gunnerus under its own DP, with an effect hidden in its measured log.

Written apart from the models that a diagnosis uses, and importing nothing of the project.
"""

from truth.cases import Case, draw, draw_many, weekly_seed

__all__ = ["Case", "draw", "draw_many", "weekly_seed"]
