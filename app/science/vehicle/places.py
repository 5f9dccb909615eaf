"""Where elements stand in a car's XML, in bytes."""

from __future__ import annotations

from dataclasses import dataclass, field
from xml.parsers import expat

from app.science.errors import VehicleConfigError


@dataclass(slots=True)
class Places:
    """Byte offsets in a file.

    Attributes
    ----------
    wanted : list of (int, int)
        From the first byte of each wanted element to the one after its last.
    before : int
        Where the first of the elements that stay last begins, or else the root's closing tag.
    empty_root : (int, int) or None
        The root itself, where it holds nothing and closes itself.
    """

    wanted: list[tuple[int, int]] = field(default_factory=list)
    before: int = -1
    empty_root: tuple[int, int] | None = None


def find_places(xml: bytes, wanted: str, last: str) -> Places:
    """Find children of the root in a file that is known to be a car's XML, without document type or entities.

    Parameters
    ----------
    xml : bytes
    wanted, last : str
        Tag of the elements looked for, and of those that stay at the end.

    Raises
    ------
    VehicleConfigError
        When the file's encoding isn't one that places can be found in.
    """
    finder = _Finder(wanted, last)
    try:
        finder.parser.Parse(xml, True)
    except (expat.ExpatError, ValueError, LookupError) as error:
        raise VehicleConfigError("The file's encoding can't be worked with; save it as UTF-8.") from error
    start, end = finder.root
    if finder.inside == 0 and xml[start:end].replace(b"\x00", b"").endswith(b"/>"):
        finder.places.empty_root = (start, end)
    return finder.places


class _Finder:
    """An element's last byte is known when whatever follows it begins."""

    def __init__(self, wanted: str, last: str) -> None:
        self.places = Places()
        self.parser = expat.ParserCreate()
        self.parser.StartElementHandler = self._start
        self.parser.EndElementHandler = self._end
        self.parser.DefaultHandler = self._other
        self.root = (0, 0)
        self.inside = 0
        self._wanted, self._last = wanted, last
        self._starts: list[int] = []
        self._ended: int | None = None

    def _settle(self) -> int:
        at = self.parser.CurrentByteIndex
        if self._ended is not None:
            self.places.wanted.append((self._ended, at))
            self._ended = None
        self.inside += len(self._starts) > 0
        return at

    def _start(self, name: str, _: dict[str, str]) -> None:
        at = self._settle()
        self._starts.append(at)
        if len(self._starts) == 2 and name == self._last and self.places.before < 0:
            self.places.before = at

    def _end(self, name: str) -> None:
        inside = self.inside
        at = self._settle()
        start = self._starts.pop()
        if len(self._starts) == 1 and name == self._wanted:
            self._ended = start
        if not self._starts:
            self.root, self.inside = (start, at), inside
            self.places.before = at if self.places.before < 0 else self.places.before

    def _other(self, _: str) -> None:
        self._settle()
