"""What the tests in conformance have at hand too."""

from conformance.conftest import compiler, stated
