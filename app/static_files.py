"""Style sheets, scripts and Plotly, each at an address that changes with its content.

The folder's content hash is part of the path, so that modules which import each other by relative path all come from
the same build, and a browser may keep them for ever.
"""

from __future__ import annotations

import gzip
import hashlib
import re
from functools import cache
from importlib import resources
from mimetypes import guess_type
from pathlib import Path

from fastapi import APIRouter, Request, Response
from starlette.staticfiles import StaticFiles

STATIC_DIR = Path(__file__).resolve().parent.parent / "frontend" / "static"
IMPORTS = re.compile(r'^import .*from "(\.[^"]+)";$', re.MULTILINE)
FOREVER = "public, max-age=31536000, immutable"

router = APIRouter(include_in_schema=False)
_files = StaticFiles(directory=STATIC_DIR)


@cache
def _contents() -> dict[str, bytes]:
    """Read all files of the folder, which are small and many: a page asks for dozens at once."""
    paths = sorted(path for path in STATIC_DIR.rglob("*") if path.is_file())
    return {path.relative_to(STATIC_DIR).as_posix(): path.read_bytes() for path in paths}


@cache
def static_version() -> str:
    """Return the hash over all files of the folder, 12 hexadecimal digits."""
    digest = hashlib.sha256()
    for path, content in _contents().items():
        digest.update(path.encode() + b"\0" + content + b"\0")
    return digest.hexdigest()[:12]


def asset_url(path: str) -> str:
    """Return the address of a file below ``frontend/static``."""
    return f"/static/{static_version()}/{path}"


@cache
def modules_of(script: str) -> tuple[str, ...]:
    """Return the addresses of all modules that a script needs, so that a browser may fetch them at once."""
    found: dict[Path, None] = {}
    waiting = [STATIC_DIR / script]
    while waiting:
        module = waiting.pop()
        if module not in found:
            found[module] = None
            waiting += [(module.parent / target).resolve() for target in IMPORTS.findall(module.read_text())]
    return tuple(asset_url(module.relative_to(STATIC_DIR).as_posix()) for module in found)


@cache
def _plotly() -> bytes:
    return (resources.files("plotly") / "package_data" / "plotly.min.js").read_bytes()


@cache
def _plotly_gzipped() -> bytes:
    return gzip.compress(_plotly(), compresslevel=6, mtime=0)


def make_ready() -> None:
    """Read and compress what the first page would wait for."""
    static_version()
    plotly_version()
    _plotly_gzipped()


@cache
def plotly_version() -> str:
    """Return the hash of the Plotly library that comes with the Python package, 12 hexadecimal digits."""
    return hashlib.sha256(_plotly()).hexdigest()[:12]


def plotly_url() -> str:
    """Return the address of the Plotly library."""
    return f"/static/vendor/plotly.min.js?v={plotly_version()}"


@router.get("/static/vendor/plotly.min.js")
def plotly_script(request: Request) -> Response:
    """Serve Plotly, compressed for every client that can take it."""
    headers = {"Cache-Control": FOREVER, "ETag": f'"{plotly_version()}"', "Vary": "Accept-Encoding"}
    if headers["ETag"] in request.headers.get("if-none-match", ""):
        return Response(status_code=304, headers=headers)
    if "gzip" not in request.headers.get("accept-encoding", ""):
        return Response(_plotly(), media_type="text/javascript", headers=headers)
    return Response(_plotly_gzipped(), media_type="text/javascript", headers={**headers, "Content-Encoding": "gzip"})


@router.get("/static/{version}/{path:path}")
async def static_file(version: str, path: str, request: Request) -> Response:
    """Serve a file; one of another build (a page open since before an upgrade) is served but not kept."""
    if version == static_version() and (content := _contents().get(path)) is not None:
        return Response(content, media_type=guess_type(path)[0], headers={"Cache-Control": FOREVER})
    response = await _files.get_response(path, request.scope)
    response.headers["Cache-Control"] = FOREVER if version == static_version() else "no-cache"
    return response
