"""Reviews turned into rules over the sources' syntax trees."""

from __future__ import annotations

import ast
import re
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PYTHON = [path.relative_to(ROOT) for room in ("app", "workers", "migrations") for path in (ROOT / room).rglob("*.py")]
WRITTEN = [*PYTHON, *(path.relative_to(ROOT) for path in (ROOT / "tests").rglob("*.py"))]
PAGES = [
    path.relative_to(ROOT)
    for kind in ("*.js", "*.css", "*.html")
    for path in (ROOT / "frontend").rglob(kind)
    if "vendor" not in path.parts
]
LONGEST_FILE = 320
LONGEST_HANDLER = 15
SQL_VERBS = {"select", "insert", "update", "delete", "text", "exists", "union", "union_all"}


def hand_written_tenant_filters(tree: ast.AST) -> Iterator[int]:
    """Comparisons with a ``fleet_id``, and ``filter_by(fleet_id=…)``: sessions filter by fleet on their own."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Compare):
            sides = [node.left, *node.comparators]
            if any(isinstance(side, ast.Attribute) and side.attr == "fleet_id" for side in sides):
                yield node.lineno
        filters = isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute) and node.func.attr == "filter_by"
        if filters and any(keyword.arg == "fleet_id" for keyword in node.keywords):
            yield node.lineno


def sql(tree: ast.AST) -> Iterator[int]:
    """Imports of SQLAlchemy's statements."""
    for node in ast.walk(tree):
        ours = isinstance(node, ast.ImportFrom) and (node.module or "").split(".")[0] == "sqlalchemy"
        if ours and any(name.name in SQL_VERBS for name in node.names):
            yield node.lineno


def long_handlers(tree: ast.AST) -> Iterator[int]:
    """Routes and tasks whose body, without its docstring, is longer than a handler may be."""
    for node in ast.walk(tree):
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef) and any(map(registers, node.decorator_list)):
            body = node.body[1:] if ast.get_docstring(node) else node.body
            if body and (body[-1].end_lineno or 0) - body[0].lineno + 1 > LONGEST_HANDLER:
                yield node.lineno


def registers(decorator: ast.expr) -> bool:
    verbs = {"get", "post", "put", "patch", "delete", "head", "options", "task", "api_route"}
    return (
        isinstance(decorator, ast.Call) and isinstance(decorator.func, ast.Attribute) and decorator.func.attr in verbs
    )


def is_storage(path: Path) -> bool:
    return path.parts[0] == "migrations" or path.parts[:2] == ("app", "storage")


Rule = Callable[[ast.AST], Iterator[int]]


def offenders(rule: Rule, allowed: Callable[[Path], bool]) -> list[str]:
    return [
        f"{path}:{line}"
        for path in PYTHON
        if not allowed(path)
        for line in rule(ast.parse((ROOT / path).read_text(encoding="utf-8")))
    ]


def test_nobody_writes_a_tenant_filter_by_hand() -> None:
    assert offenders(hand_written_tenant_filters, is_storage) == []


def test_sql_stands_in_repositories_only() -> None:
    assert offenders(sql, lambda path: is_storage(path) or path.name == "repository.py") == []


def test_handlers_and_tasks_are_short() -> None:
    assert offenders(long_handlers, lambda path: path.parts[:2] == ("app", "cli")) == []


@pytest.mark.parametrize(
    ("rule", "bad", "good"),
    [
        (hand_written_tenant_filters, "q.where(Car.fleet_id == mine)", "q.where(Car.name == name)"),
        (hand_written_tenant_filters, "q.filter_by(fleet_id=mine)", "q.filter_by(name=name)"),
        (sql, "from sqlalchemy import select", "from sqlalchemy.orm import Session"),
        (long_handlers, "@router.get('/')\ndef f():\n" + "    x()\n" * 16, "def f():\n" + "    x()\n" * 16),
    ],
)
def test_the_rules_see_what_they_are_for(rule: Rule, bad: str, good: str) -> None:
    assert list(rule(ast.parse(bad)))
    assert not list(rule(ast.parse(good)))


def test_no_file_is_long() -> None:
    lines = {str(path): (ROOT / path).read_text(encoding="utf-8").count("\n") for path in [*WRITTEN, *PAGES]}
    assert {path: count for path, count in lines.items() if count > LONGEST_FILE} == {}


def test_traces_are_drawn_as_svg() -> None:
    """WebGL scatter takes tens of seconds to zoom on a machine without a graphics card."""
    drawing = [path for path in [*PYTHON, *PAGES] if "scattergl" in (ROOT / path).read_text(encoding="utf-8").lower()]
    assert drawing == []


def test_nothing_is_left_for_later_and_no_machine_or_index_is_named() -> None:
    # a letter in brackets keeps each pattern from finding itself here
    marks = re.compile(
        r"\b(TO[D]O|FIX[M]E|XX[X]|HAC[K])\b|/roo[t]/|/tm[p]/|index-ur[l]|find-link[s]|pypi\.org|pythonhoste[d]"
    )
    texts = [*WRITTEN, *PAGES, *map(Path, ("ponthy", ".ci/run", "Dockerfile", "docker-compose.yml", "README.md"))]
    found = {
        f"{path}: {match.group()}"
        for path in texts
        for match in marks.finditer((ROOT / path).read_text(encoding="utf-8"))
    }
    assert found == set()
