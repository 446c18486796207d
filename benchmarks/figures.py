# SPDX-License-Identifier: MIT
"""Means of figures, and figures as text, as the tables of RESULTS.md have them."""
import math


def mean(numbers):
    return sum(numbers) / len(numbers) if numbers else None


def ratio(pairs, of):
    """The geometric mean of what `of` says of the second over what it says of the first; nothing
    if it says it of no pair."""
    logs = [math.log(of(b) / of(a)) for a, b in pairs if of(a) and of(b)]
    return math.exp(mean(logs)) if logs else None


def number(value, digits=0, scale=1.0):
    return "–" if value is None else f"{value * scale:.{digits}f}"


def ranges(numbers):
    """1, 2, 3, 5 as 1–3, 5."""
    runs = []
    for n in sorted(numbers):
        if runs and runs[-1][-1] == n - 1:
            runs[-1].append(n)
        else:
            runs.append([n])
    return ", ".join(str(r[0]) if len(r) == 1 else f"{r[0]}–{r[-1]}" for r in runs)
