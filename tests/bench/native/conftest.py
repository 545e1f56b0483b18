"""What the tests in native have at hand too."""

from native.conftest import compiler
