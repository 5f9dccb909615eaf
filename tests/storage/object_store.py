"""A small object store that speaks enough of S3 for the tests; it keeps all in memory and checks no signature."""

from __future__ import annotations

import re
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from urllib.parse import parse_qs, unquote, urlsplit
from xml.sax.saxutils import escape

WHEN = "2026-03-01T08:00:00.000Z"
HTTP_WHEN = "Sun, 01 Mar 2026 08:00:00 GMT"


class Bucket(BaseHTTPRequestHandler):
    """Answers for one bucket; keys are paths below it."""

    protocol_version = "HTTP/1.1"
    objects: dict[str, bytes]
    parts: dict[str, dict[int, bytes]]

    def log_message(self, *_: object) -> None:
        """Say nothing."""

    def _where(self) -> tuple[str, dict[str, str]]:
        address = urlsplit(self.path)
        query = {name: values[0] for name, values in parse_qs(address.query, keep_blank_values=True).items()}
        return unquote(address.path).lstrip("/").partition("/")[2], query

    def _body(self) -> bytes:
        return self.rfile.read(int(self.headers.get("Content-Length", 0)))

    def _answer(self, status: int, body: bytes = b"", length: int | None = None, **headers: str) -> None:
        self.send_response(status)
        for name, value in {"ETag": '"x"', "Last-Modified": HTTP_WHEN, **headers}.items():
            self.send_header(name.replace("_", "-"), value)
        self.send_header("Content-Length", str(len(body) if length is None else length))
        self.end_headers()
        self.wfile.write(body)

    def do_PUT(self) -> None:
        key, query = self._where()
        body = self._body()
        if "partNumber" in query:
            self.parts[query["uploadId"]][int(query["partNumber"])] = body
        elif self.headers.get("If-None-Match") == "*" and key in self.objects:
            self._answer(412)
            return
        else:
            self.objects[key] = body
        self._answer(200)

    def do_POST(self) -> None:
        key, query = self._where()
        body = self._body()
        if "uploads" in query:
            upload = f"u{len(self.parts)}"
            self.parts[upload] = {}
            result = f"<InitiateMultipartUploadResult><UploadId>{upload}</UploadId></InitiateMultipartUploadResult>"
        elif "uploadId" in query:
            parts = self.parts.pop(query["uploadId"])
            self.objects[key] = b"".join(parts[number] for number in sorted(parts))
            result = "<CompleteMultipartUploadResult><ETag>x</ETag></CompleteMultipartUploadResult>"
        else:
            keys = re.findall("<Key>(.*?)</Key>", body.decode())
            for key in keys:
                self.objects.pop(key, None)
            deleted = "".join(f"<Deleted><Key>{key}</Key></Deleted>" for key in keys)
            result = f"<DeleteResult>{deleted}</DeleteResult>"
        self._answer(200, result.encode())

    def do_DELETE(self) -> None:
        self.objects.pop(self._where()[0], None)
        self._answer(204)

    def do_HEAD(self) -> None:
        data = self.objects.get(self._where()[0])
        self._answer(404 if data is None else 200, length=len(data or b""))

    def do_GET(self) -> None:
        key, query = self._where()
        if "list-type" in query:
            self._answer(200, self._listing(query.get("prefix", "")))
        elif key not in self.objects:
            self._answer(404, b"<Error><Code>NoSuchKey</Code></Error>")
        else:
            self._answer(200, self.objects[key])

    def _listing(self, prefix: str) -> bytes:
        entries = "".join(
            f"<Contents><Key>{escape(key)}</Key><Size>{len(data)}</Size>"
            f"<LastModified>{WHEN}</LastModified><ETag>x</ETag></Contents>"
            for key, data in sorted(self.objects.items())
            if key.startswith(prefix)
        )
        return f"<ListBucketResult><IsTruncated>false</IsTruncated>{entries}</ListBucketResult>".encode()


@contextmanager
def running_store() -> Iterator[str]:
    """Run an empty store on loopback; give its endpoint."""
    handler = type("FreshBucket", (Bucket,), {"objects": {}, "parts": {}})
    server = ThreadingHTTPServer(("127.0.0.1", 0), handler)
    thread = threading.Thread(target=server.serve_forever, kwargs={"poll_interval": 0.05}, daemon=True)
    thread.start()
    yield f"http://127.0.0.1:{server.server_address[1]}"
    server.shutdown()
    server.server_close()
    thread.join()
