"""The trial of the diagnosis: logs with a hidden effect are drawn, diagnosed and scored, and the rates tabulated.

Only here do the independent truth (`tests/bench/truth`) and the diagnosis meet; each knows nothing of the other.
"""

from trial.runs import SETS, diagnosed, run
from trial.scoring import Score, score
from trial.tables import rates, table

__all__ = ["SETS", "Score", "diagnosed", "rates", "run", "score", "table"]
