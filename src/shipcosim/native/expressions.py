"""Expressions of the C text: a value that only the next line uses is written into it, without a variable."""

import re
from collections import Counter

MOST_WORDS = 25
"""Words of two lines that become one of some 100 characters. Equal functions have equal numbers of words, which their
characters are not: names of variables differ in length."""
_VARIABLE = re.compile(r"\bv\d+\b")
_DECLARATION = re.compile(r" *const (\w+) (v\d+) = (.*);")


def merged(lines: list[str]) -> list[str]:
    """Write the values that are used once, in the line that follows, where they are used.

    Nothing happens between the two lines, so the values stay the same. The compiler fuses no operations: each rounds
    to a double, with or without a variable. An empty line comes first.
    """
    uses = Counter(name for line in lines for name in _VARIABLE.findall(line))
    written = [""]
    for line in lines:
        while joined := _joined(written[-1], line, uses):
            written.pop()
            line = joined
        written.append(line)
    return written


def _joined(declaration: str, line: str, uses: Counter[str]) -> str:
    """A line with the value that is declared before it; empty where that keeps its variable."""
    declared = _DECLARATION.fullmatch(declaration)
    if declared is None:
        return ""
    kind, name, value = declared.groups()
    place = next((found for found in _VARIABLE.finditer(line) if found[0] == name), None)
    # A variable that is used once occurs twice.
    if place is None or uses[name] != 2:
        return ""
    # A truth value in an array is a double, which only its variable makes an int.
    is_truth_of_array = kind == "int" and value.endswith("]") and " " not in value
    # A loop would compute the value in each turn.
    is_loop = "for (" in line
    # A count of truth values is an int without its variable, which only a division tells from a double.
    is_division = " / " in line
    is_long = len(declaration.split()) + len(line.split()) > MOST_WORDS
    if is_truth_of_array or is_loop or is_division or is_long:
        return ""
    before, after = line[: place.start()], line[place.end() :]
    return before + (value if _is_whole(before, value, after) else f"({value})") + after


def _is_whole(before: str, value: str, after: str) -> bool:
    """Whether C reads a value as a whole between what stands before and behind it, without parentheses."""
    # It is all between brackets, commas or the ends of a statement.
    if before.endswith((" = ", "(", ", ")) and after.startswith((",", ";", ")")):
        return True
    # A sign or a cast before it would act on its first operand alone.
    if not before.endswith((" ", "(")):
        return False
    # C goes from left to right, as Python does: only what stands before it, or binds more closely behind it, matters.
    operators = _operators(value)
    last = before.rstrip()[-1:]
    if operators <= {"*", "/"}:
        return not operators or last not in "*/"
    return (
        operators <= {"+", "-", "*", "/"}
        and last not in "+-*/"
        and not after.startswith((" * ", " / "))
    )


def _operators(value: str) -> set[str]:
    """Operators of an expression outside its brackets: they stand between spaces."""
    flat = value
    while (shorter := re.sub(r"\([^()]*\)", "x", flat)) != flat:
        flat = shorter
    return set(flat.split()[1::2])
