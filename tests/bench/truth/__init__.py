"""An independent truth: the lengthened Gunnerus under its own DP, with an effect hidden in its measured log.

Written apart from the models that a diagnosis uses, and importing nothing of the project.
"""

from truth.cases import Case, bench_seed, draw, draw_many

__all__ = ["Case", "bench_seed", "draw", "draw_many"]
