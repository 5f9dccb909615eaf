"""Sets of terms ωⁱ Tʲ, by the highest power of one variable, which is how the thesis groups them (3.4.1)."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from app.science.arrays import FloatArray
from app.science.errors import ScienceError

DEGREES = (2, 3, 4)
Term = tuple[int, int]
"""Powers of engine speed and of torque."""


class FitError(ScienceError):
    """The map doesn't carry the fit that was asked for."""

    code = "fit-impossible"


@dataclass(frozen=True, slots=True)
class TermSet:
    """A formula's terms under a name.

    Attributes
    ----------
    name : str
    terms : tuple of Term
        Without repetition, in the order of the coefficients.
    """

    name: str
    terms: tuple[Term, ...]

    @property
    def degree(self) -> int:
        """Highest power of one variable."""
        return max(max(term) for term in self.terms)

    def columns(self, omega: FloatArray, torque: FloatArray) -> FloatArray:
        """Return the terms' values, shape (n, terms)."""
        of_omega, of_torque = (
            _powers(values, max(term[k] for term in self.terms)) for k, values in enumerate((omega, torque))
        )
        return np.column_stack([of_omega[i] * of_torque[j] for i, j in self.terms])

    def combined(self, coefficients: FloatArray, omega: FloatArray, torque: FloatArray) -> FloatArray:
        """Return the sum of the terms times their coefficients, shape (n,), without keeping the terms."""
        total = np.zeros(np.broadcast_shapes(np.shape(omega), np.shape(torque)))
        of_torque = _powers(torque, max(j for _, j in self.terms))
        of_omega = _powers(omega, max(i for i, _ in self.terms))
        for j, power in enumerate(of_torque):
            own = [(i, c) for (i, other), c in zip(self.terms, coefficients, strict=True) if other == j]
            if own:
                total += power * sum((c * of_omega[i] for i, c in own), np.zeros(np.shape(omega)))
        return total

    def words(self) -> tuple[str, ...]:
        """Return the terms as text: ``1``, ``ω``, ``ω²T`` …"""
        return tuple(_power("ω", i) + _power("T", j) or "1" for i, j in self.terms)


def _powers(values: FloatArray, highest: int) -> list[FloatArray]:
    """Return the powers from 0 up, by multiplying: NumPy's own are slow above 2."""
    found = [np.ones(np.shape(values))]
    for _ in range(highest):
        found.append(found[-1] * values)
    return found


def _power(letter: str, exponent: int) -> str:
    return "" if exponent == 0 else letter + ("" if exponent == 1 else str(exponent).translate(_RAISED))


_RAISED = str.maketrans("0123456789", "⁰¹²³⁴⁵⁶⁷⁸⁹")
_PLAIN = str.maketrans("⁰¹²³⁴⁵⁶⁷⁸⁹", "0123456789")

_PRINTED = (
    TermSet("powers of ωT", ((0, 0), (1, 1), (2, 1), (1, 2))),
    TermSet("powers of ωT with ω²T²", ((0, 0), (1, 1), (2, 1), (1, 2), (2, 2))),
    TermSet("table 4.1", ((0, 0), (1, 0), (0, 1), (1, 1), (2, 0), (0, 2))),
    TermSet("figure 3.19", ((0, 0), (1, 1), (2, 1), (1, 2), (3, 0), (1, 3))),
    TermSet("figure 3.15", ((0, 0), (1, 1), (2, 1), (1, 2), (2, 2), (3, 0), (1, 3), (1, 4), (0, 4))),
    TermSet("figure 3.18", ((0, 0), (1, 1), (2, 1), (1, 2), (2, 2), (0, 3), (3, 0), (1, 3), (0, 4))),
)
"""Formulas printed in the thesis; the captions of figures 3.9 to 3.11 did not survive scanning, the first two and the
whole classes below stand in for them."""


def classes(degree: int) -> tuple[TermSet, ...]:
    """Return the formulas whose highest power of one variable is ``degree``, those with the fewest terms first.

    Beside the thesis' own: all terms up to that degree in total, and all up to it in each variable.

    Raises
    ------
    FitError
        For another degree than 2, 3 or 4.
    """
    if degree not in DEGREES:
        raise FitError(f"There are formulas of highest power 2, 3 and 4, not {degree}.")
    every = [(i, j) for i in range(degree + 1) for j in range(degree + 1)]
    whole = (
        TermSet(f"all of total degree {degree}", tuple(term for term in every if sum(term) <= degree)),
        TermSet(f"all of degree {degree} in each", tuple(every)),
    )
    found = [one for one in _PRINTED if one.degree == degree]
    known = {frozenset(one.terms) for one in found}
    found += [one for one in whole if frozenset(one.terms) not in known]
    return tuple(sorted(found, key=lambda one: len(one.terms)))


def chosen_terms(words: Iterable[str]) -> TermSet:
    """Return the formula with the terms a person wrote: ``1``, ``w``, ``T``, ``w2T``, ``ω²T³`` …

    Raises
    ------
    FitError
        For a word that isn't a term, or one that comes twice.
    """
    terms: list[Term] = []
    for word in words:
        term = _term(word)
        if term is None:
            raise FitError(f"{word!r} is not a term; terms are 1, w, T, wT, w2T3 and the like, with powers up to 9.")
        if term in terms:
            raise FitError(f"{word!r} comes twice.")
        terms.append(term)
    if not terms:
        raise FitError("No term was named; name at least one, such as 1.")
    return TermSet("chosen", tuple(terms))


def _term(word: str) -> Term | None:
    text = word.strip().replace("^", "").replace("*", "").replace("ω", "w").translate(_PLAIN)
    if text == "1":
        return 0, 0
    powers = {"w": 0, "T": 0}
    at = 0
    while at < len(text):
        letter = text[at]
        has_digit = at + 1 < len(text) and text[at + 1].isdigit()
        if letter not in powers or powers[letter]:
            return None
        powers[letter] = int(text[at + 1]) if has_digit else 1
        if not powers[letter]:
            return None
        at += 2 if has_digit else 1
    return (powers["w"], powers["T"]) if text else None
