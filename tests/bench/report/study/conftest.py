"""What the tests in report/study have at hand too."""

from report.study.conftest import study_of
