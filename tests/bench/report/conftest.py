"""What the tests in report have at hand too."""

from report.conftest import browse, chromium, four_corner, scenario, shown_at, verdicts
