"""What the tests in report/diagnosis have at hand too."""

from report.diagnosis.conftest import diagnosis, predicted
