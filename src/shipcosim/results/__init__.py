"""What the calls of `import shipcosim` give back: results that know how to show themselves, in a notebook and outside.

Each holds what was found, as the room that found it returns it, and adds a card, pictures and its page.
"""

from shipcosim.results.shown import HtmlPage, Picture

__all__ = ["HtmlPage", "Picture"]
