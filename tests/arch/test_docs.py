"""What the documents name exists, and what exists is documented."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
import typer.main
from pydantic import SecretStr

from app.cli.bench.command import BENCHMARKS
from app.cli.main import app
from app.science.logger.recording import SIGNAL_UNITS
from app.science.vehicle.fields import FIELDS
from app.settings import Settings

ROOT = Path(__file__).resolve().parents[2]
DOCUMENTS = sorted([ROOT / "README.md", ROOT / "CHANGELOG.md", *(ROOT / "docs").glob("*.md")])


def command_names() -> list[str]:
    group = typer.main.get_group(app)
    names: list[str] = []
    for name, command in group.commands.items():
        inner = getattr(command, "commands", None)
        names += [f"{name} {word}" for word in inner] if inner else [name]
    return names


def shown(value: object) -> str:
    if value is None or isinstance(value, SecretStr) or value == "":
        return ""
    return f"`{str(value).lower() if isinstance(value, bool) else value}`"


@pytest.mark.parametrize("name", Settings.model_fields)
def test_every_setting_is_documented(name: str) -> None:
    field = Settings.model_fields[name]
    row = f"| `PONTHY_{name.upper()}` | {shown(field.default)} | {field.description} |".replace("|  |", "| |")
    assert row in (ROOT / "docs" / "settings.md").read_text(encoding="utf-8")


def test_no_document_names_a_setting_that_is_not_there() -> None:
    known = {f"PONTHY_{name.upper()}" for name in Settings.model_fields}
    elsewhere = {"PONTHY_DEBUG", "PONTHY_TOKEN", "PONTHY_PUBLISH"}  # the command line's, and the compose file's
    text = "\n".join(document.read_text(encoding="utf-8") for document in DOCUMENTS)
    assert set(re.findall(r"PONTHY_[A-Z0-9_]+", text)) <= known | elsewhere


@pytest.mark.parametrize("name", [*command_names(), *BENCHMARKS])
def test_every_command_and_benchmark_is_documented(name: str) -> None:
    assert re.search(rf"`{name}[ `]", (ROOT / "docs" / "commands.md").read_text(encoding="utf-8"))


def test_every_value_of_the_cars_xml_and_every_signal_is_documented() -> None:
    text = (ROOT / "docs" / "formats.md").read_text(encoding="utf-8")
    names = [field.path.removeprefix("transmission/").removesuffix("@gear") for field in FIELDS]
    assert [name for name in names if not re.search(rf"[`/]{re.escape(name)}[`@]", text)] == []
    assert [name for name in SIGNAL_UNITS if not re.search(rf"[` \n]{name}[` \n]", text)] == []


@pytest.mark.parametrize("document", DOCUMENTS, ids=lambda path: path.name)
def test_documents_call_only_commands_that_are_there(document: Path) -> None:
    first_words = {name.split()[0] for name in command_names()} | {"COMMAND"}
    called = set(re.findall(r"\./ponthy ([a-z][a-z-]*)", document.read_text(encoding="utf-8")))
    assert called <= first_words


@pytest.mark.parametrize("document", DOCUMENTS, ids=lambda path: path.name)
def test_links_lead_somewhere(document: Path) -> None:
    links = re.findall(r"\]\(([^)#]+)\)", document.read_text(encoding="utf-8"))
    local = [link for link in links if not link.startswith("http")]
    assert [link for link in local if not (document.parent / link).exists()] == []
