"""Rules that every template, style sheet and module of the pages keeps."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from app.static_files import STATIC_DIR
from app.templating import TEMPLATE_DIR

TEMPLATES = sorted(TEMPLATE_DIR.glob("*.html"))
MODULES = sorted(STATIC_DIR.glob("js/**/*.js"))
SHEETS = sorted(STATIC_DIR.glob("css/*.css"))

MARKUP_FROM_DATA = re.compile(
    r"innerHTML|outerHTML|insertAdjacentHTML|document\.write|\beval\(|new Function|setTimeout\(\""
)
FOREIGN = re.compile(r"""["'(=]\s*(https?:)?//(?!www\.w3\.org/)[\w.-]+\.\w""")


def name(path: Path) -> str:
    return path.name


@pytest.mark.parametrize("path", TEMPLATES, ids=name)
def test_templates_have_no_script_or_handler_of_their_own(path: Path) -> None:
    text = path.read_text()
    assert not re.search(r"<script(?![^>]*\bsrc=)", text), "the content-security policy refuses inline scripts"
    assert not re.search(r"\son\w+=", text), "the content-security policy refuses inline handlers"
    assert "|safe" not in text
    assert not FOREIGN.search(text), "pages ask no other host for anything"


@pytest.mark.parametrize("path", MODULES, ids=name)
def test_modules_build_nodes_never_markup_and_stay_short(path: Path) -> None:
    text = path.read_text()
    assert not MARKUP_FROM_DATA.search(text), "build nodes with h() and text, so that no name becomes a script"
    assert not FOREIGN.search(text), "pages ask no other host for anything"
    assert len(text.splitlines()) <= 300


@pytest.mark.parametrize("path", SHEETS, ids=name)
def test_style_sheets_ask_nobody_and_take_every_colour_from_the_tokens(path: Path) -> None:
    text = path.read_text()
    assert "url(" not in text
    assert "@import" not in text
    if path.name != "tokens.css":
        assert not re.findall(r"#[0-9a-fA-F]{3,8}\b", text), "colours stand in tokens.css, for both themes"


def test_every_field_of_the_templates_has_a_label() -> None:
    for path in TEMPLATES:
        text = path.read_text()
        for tag in re.findall(r"<(?:input|select|textarea)\b[^>]*>", text):
            if 'type="radio"' in tag:
                continue  # stands inside its label
            identifier = re.search(r'\bid="([^"]+)"', tag)
            assert identifier, f"{path.name}: {tag}"
            labelled = f'for="{identifier[1]}"' in text or "aria-label" in tag
            assert labelled, f"{path.name}: {tag} has no label"


def test_every_tab_names_a_panel_that_names_the_tab() -> None:
    for path in TEMPLATES:
        text = path.read_text()
        for tab, panel in re.findall(r'role="tab" id="([^"]+)" aria-controls="([^"]+)"', text):
            assert re.search(rf'role="tabpanel" id="{panel}" aria-labelledby="{tab}"', text), f"{path.name}: {tab}"


def test_identifiers_that_modules_look_up_stand_in_a_template() -> None:
    known = set(re.findall(r'\bid="([\w-]+)"', "".join(path.read_text() for path in TEMPLATES)))
    for path in MODULES:
        for identifier in re.findall(r'byId\("([\w-]+)"\)', path.read_text()):
            assert identifier in known, f"{path.name} looks for #{identifier}"
