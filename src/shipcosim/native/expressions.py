"""Expressions of the C text: a value that only the next line uses is written into it, without a variable."""

import re
from collections import Counter

# A declaration, and the next line before and behind the use of its variable.
_PAIR = (
    # Together they have at most 25 words: the new line has some 100 characters. Equal functions have equal numbers of
    # words, and not of characters.
    r"(?=\s*(?:\S+\s+){,24}\S+$)"
    # A truth value in an array is a double, which only its variable makes an int.
    r" *const (?!int v\d+ = [^ ]*\];)\w+ (v\d+) = (.*);\n"
    # A loop would compute the value in each turn. A count of truth values is an int of C without its variable, and the
    # only operation in which that matters is a division.
    r"((?!.*(?:for \(| / )).*)\b\1\b(.*)"
)

# An expression, between two `#`, that C reads as a whole at its place, without parentheses.
_BARE = (
    # It is all between brackets, commas or the ends of a statement.
    r"(?: = |\(|, )#.*#[,;)]"
    # An operand (x: no spaces but in brackets), unless a sign or a cast stands before it.
    r"|[ (]#x#"
    # A product that is not behind a product. C goes from left to right, as Python does.
    r"|(?:[^*/] |\()#x(?: [*/] x)*#"
    # A sum that is not behind a sum, nor beside a product.
    r"|(?:[^-+*/] |\()#x(?: [-+*/] x)*#(?! [*/])"
).replace("x", r"(?:[^ ()]|\((?:[^()]|\((?:[^()]|\([^()]*\))*\))*\))+")


def merged(lines: list[str]) -> list[str]:
    """Write the values that are used once, in the line that follows, where they are used.

    Nothing happens between the two lines, so the values stay the same. The compiler fuses no operations: each rounds
    to a double, with or without a variable. An empty line comes first.
    """
    uses = Counter(re.findall(r"\bv\d+\b", "\n".join(lines)))
    written = [""]
    for line in lines:
        # A variable that is used once occurs twice.
        while (pair := re.fullmatch(_PAIR, f"{written[-1]}\n{line}")) and uses[pair[1]] == 2:
            written.pop()
            is_bare = re.search(_BARE, pair.expand(r"\3#\2#\4"))
            line = pair.expand(r"\3\2\4" if is_bare else r"\3(\2)\4")
        written.append(line)
    return written
