"""A car's XML as a document: parsed without trust, changed value by value, written back with all it held."""

from __future__ import annotations

import codecs
import hashlib
import re
from collections.abc import Iterator
from dataclasses import dataclass

from lxml import etree

from app.science.errors import VehicleConfigError

ROOT = "ponthy_config"
LARGEST_BYTES = 1_000_000
DEEPEST = 32
MOST_ELEMENTS = 20_000


@dataclass(frozen=True, slots=True)
class Found:
    """The text of an attribute and the line of its element."""

    text: str
    line: int


class ConfigDocument:
    """One ``<ponthy_config>`` file in memory.

    Parameters
    ----------
    xml : bytes
        The file. Document types and entities are refused, nothing outside the file is ever read.

    Raises
    ------
    VehicleConfigError
        When it is too large, not XML, nested too deeply, or another kind of XML. `line` says where.
    """

    def __init__(self, xml: bytes) -> None:
        self._source = xml
        self._changed = False
        self._tree = _parse(xml)
        self._root = self._tree.getroot()

    def find(self, element: str, attribute: str) -> Found | None:
        """Return the first non-empty value of an attribute; several elements of one path are looked through."""
        for node in self._root.iterfind(element):
            text = str(node.get(attribute, "")).strip()
            if text:
                return Found(text, _line(node))
        return None

    def attributes(self) -> Iterator[tuple[str, int]]:
        """Yield every attribute below the root as ``element@attribute`` with its line."""
        for node in self._root.iterdescendants(etree.Element):
            steps = [str(node.tag), *(str(parent.tag) for parent in node.iterancestors())][:-1]
            for name in node.attrib:
                yield f"{'/'.join(reversed(steps))}@{name}", _line(node)

    def values(self, element: str, attribute: str) -> tuple[str, ...]:
        """Return all values of an attribute in document order."""
        found = (str(node.get(attribute, "")).strip() for node in self._root.iterfind(element))
        return tuple(text for text in found if text)

    def put(self, element: str, attribute: str, text: str) -> None:
        """Set a value where it stands, or where it belongs when it isn't there yet; an empty text empties it."""
        nodes = list(self._root.iterfind(element))
        node = next((one for one in nodes if str(one.get(attribute, "")).strip()), None)
        if node is None and not text:
            return
        if node is None:
            node = next((one for one in nodes if attribute in one.attrib), None)
        if node is None:
            node = nodes[0] if nodes else self._make(element)
        node.set(attribute, text)
        self._changed = True

    @property
    def encoding(self) -> str:
        """Python's name of the file's encoding, without a byte order mark of its own.

        Raises
        ------
        VehicleConfigError
            When the parser knows the encoding and Python doesn't.
        """
        name = self._tree.docinfo.encoding or "UTF-8"
        marks = {codecs.BOM_UTF16_LE: "utf-16-le", codecs.BOM_UTF16_BE: "utf-16-be"}
        name = marks.get(self._source[:2], name)
        try:
            return codecs.lookup(name).name
        except LookupError as error:
            raise VehicleConfigError(f"The encoding {name} can't be written; save the file as UTF-8.") from error

    def to_bytes(self) -> bytes:
        """Return the file: the very same bytes when nothing was changed, else in its encoding and line ends."""
        if not self._changed:
            return self._source
        encoding = self._tree.docinfo.encoding or "UTF-8"
        declared = b"<?xml" in self._source[:200].replace(b"\x00", b"")
        try:
            codecs.lookup(encoding)
        except LookupError:  # the parser knows encodings that the writer does not
            encoding, declared = "UTF-8", True
        before = reversed(list(self._root.itersiblings(preceding=True)))
        nodes = [*before, self._root, *self._root.itersiblings()]
        lines = [str(etree.tostring(node, encoding="unicode", with_tail=False)) for node in nodes]
        if declared:
            standalone = ' standalone="yes"' if self._tree.docinfo.standalone else ""
            lines.insert(0, f'<?xml version="1.0" encoding="{encoding}"{standalone}?>')
        text = "\n".join([*lines, ""])
        if b"\r\n" in self._source:
            text = text.replace("\n", "\r\n")
        return text.encode(encoding, "xmlcharrefreplace")

    def fingerprint(self) -> str:
        """Return the SHA-256 of the canonical form (C14N 2.0) without comments, blanks, attribute order, battery."""
        canonical = etree.canonicalize(self._tree, strip_text=True, with_comments=False, exclude_tags=["battery"])
        return hashlib.sha256(str(canonical).encode()).hexdigest()

    def _make(self, element: str) -> etree._Element:
        """Create the element with its missing parents, indented like its neighbours."""
        parent = self._root
        for depth, tag in enumerate(element.split("/"), start=1):
            child = parent.find(tag)
            if child is None:
                child = etree.Element(tag)
                _insert(parent, child, depth)
            parent = child
        return parent


def _insert(parent: etree._Element, child: etree._Element, depth: int) -> None:
    inner, outer = "\n" + "  " * depth, "\n" + "  " * (depth - 1)
    first_file = parent.find("file") if depth == 1 else None
    if first_file is not None:  # the list of trip files stays last
        child.tail = inner
        first_file.addprevious(child)
        return
    if len(parent):
        child.tail = parent[-1].tail or outer
        parent[-1].tail = inner
    else:
        parent.text, child.tail = inner, outer
    parent.append(child)


def _line(node: etree._Element) -> int:
    return int(node.sourceline or 0)


def _parse(xml: bytes) -> etree._ElementTree:
    if len(xml) > LARGEST_BYTES:
        raise VehicleConfigError(
            f"The file has {len(xml)} bytes; a car's XML has at most {LARGEST_BYTES}. Is this the right file?"
        )
    if not xml.strip(b"\x00 \t\r\n"):
        raise VehicleConfigError("The file is empty; a car's XML is expected.")
    parser = etree.XMLParser(
        resolve_entities=False, no_network=True, load_dtd=False, huge_tree=False, collect_ids=False
    )
    try:
        root = etree.fromstring(xml, parser)
    except etree.XMLSyntaxError as error:
        if _has_doctype(xml):
            raise _doctype(xml) from error
        line = int(error.lineno or 0)
        detail = re.sub(r",? ?\(?line \d+.*", "", str(error.msg)).strip() or "the text breaks off"
        raise VehicleConfigError(f"Line {line}: this isn't well-formed XML: {detail}.", line) from error
    tree = root.getroottree()
    if tree.docinfo.internalDTD is not None:
        raise _doctype(xml)
    _check_shape(root)
    return tree


def _check_shape(root: etree._Element) -> None:
    if root.tag != ROOT:
        name = etree.QName(root).localname
        raise VehicleConfigError(
            f"Line {_line(root)}: the outermost element is <{name}>; a car's XML begins with <{ROOT}>.",
            _line(root),
            name,
        )
    for count, node in enumerate(root.iter(etree.Element)):
        if count > MOST_ELEMENTS:
            raise VehicleConfigError(f"The file has more than {MOST_ELEMENTS} elements. Is this a car's XML?")
        if sum(1 for _ in node.iterancestors()) > DEEPEST:
            raise VehicleConfigError(
                f"Line {_line(node)}: elements are nested more than {DEEPEST} deep; a car's XML isn't.", _line(node)
            )


def _has_doctype(xml: bytes) -> bool:
    return b"<!DOCTYPE" in xml.replace(b"\x00", b"")  # without its NULs, UTF-16 is searched alike


def _doctype(xml: bytes) -> VehicleConfigError:
    line = xml.replace(b"\x00", b"").partition(b"<!DOCTYPE")[0].count(b"\n") + 1
    return VehicleConfigError(
        f"Line {line}: a document type (<!DOCTYPE …>) or entity is not accepted; delete it and write values out.", line
    )
