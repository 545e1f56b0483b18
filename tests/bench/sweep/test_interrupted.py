"""At night: a table of runs of which nothing but its name is left."""

from sweep.conftest import built, project
from sweep.test_interrupted import check_lost_table


def test_an_empty_table_of_runs_is_said_and_made_again(project):
    check_lost_table(project, 0)
