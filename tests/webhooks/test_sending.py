"""One POST: to the address that was checked, with the name's certificate, and never longer than it may take."""

from __future__ import annotations

import shutil
import socket
import ssl
import subprocess
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from ipaddress import ip_address
from pathlib import Path

import pytest

from app.webhooks.addresses import Target
from app.webhooks.sending import Answer, NotAnswered, post
from tests.webhooks.conftest import Receiver, listening, serving

LOOPBACK = [ip_address("127.0.0.1")]


@contextmanager
def saying(*pieces: bytes, pause_s: float = 0.0) -> Iterator[int]:
    """Listen for one connection and answer these pieces one by one, whatever is asked; give the port."""
    with socket.create_server(("127.0.0.1", 0)) as server:
        server.settimeout(10)
        ended = threading.Event()

        def serve() -> None:
            connection, _ = server.accept()
            with connection:
                for piece in pieces:
                    try:
                        connection.sendall(piece)
                    except OSError:
                        return  # hung up on, which is what the test is about
                    ended.wait(pause_s)
                ended.wait(10)

        thread = threading.Thread(target=serve)
        thread.start()
        yield int(server.getsockname()[1])
        ended.set()
        thread.join()


def test_the_name_is_in_the_request_and_the_address_in_the_connection(receiver: Receiver) -> None:
    target = Target(False, "hooks.example.org", receiver.port, "/in?x=1")
    receiver.answers.append((200, b"thank you\x00\x07, now\nrest"))
    assert post(target, LOOPBACK, b"{}", {"A": "b"}) == Answer(200, "thank you, now\nrest")
    (heard,) = receiver.heard
    assert (heard.path, heard.body) == ("/in?x=1", b"{}")
    assert heard.headers["Host"] == f"hooks.example.org:{receiver.port}"
    assert heard.headers["A"] == "b"


def test_a_redirection_is_an_answer_like_any_other(receiver: Receiver) -> None:
    receiver.answers.append((307, b""))
    assert post(Target(False, "x.example", receiver.port, "/"), LOOPBACK, b"{}", {}).status == 307
    assert len(receiver.heard) == 1


def test_an_address_that_refuses_leaves_the_turn_to_the_next(receiver: Receiver) -> None:
    both = [ip_address("127.0.0.9"), *LOOPBACK]
    assert post(Target(False, "x.example", receiver.port, "/"), both, b"{}", {}).status == 204
    with pytest.raises(NotAnswered, match="the connection was refused"):
        post(Target(False, "x.example", receiver.port, "/"), both[:1], b"{}", {})


def test_a_receiver_that_keeps_silent_is_left() -> None:
    with saying() as port, pytest.raises(NotAnswered, match=r"no whole answer within 0\.3 s"):
        post(Target(False, "x.example", port, "/"), LOOPBACK, b"{}", {}, timeout_s=0.3)


def test_a_receiver_that_drips_is_left() -> None:
    """Each letter comes well within the timeout of a read; all of them would take minutes."""
    drops = (b"HTTP/1.1 200 OK\r\n", *([b"X: y\r\n"] * 2000))
    with saying(*drops, pause_s=0.05) as port, pytest.raises(NotAnswered, match="no whole answer within"):
        post(Target(False, "x.example", port, "/"), LOOPBACK, b"{}", {}, timeout_s=0.5)


def test_what_is_not_http_is_said_so() -> None:
    with saying(b"SSH-2.0-x\r\n") as port, pytest.raises(NotAnswered, match="the answer was not HTTP"):
        post(Target(False, "x.example", port, "/"), LOOPBACK, b"{}", {}, timeout_s=5)


def test_an_endless_answer_is_not_read_to_its_end() -> None:
    endless = b"HTTP/1.1 200 OK\r\n\r\n" + b"y" * 1_000_000
    with saying(endless) as port:
        answer = post(Target(False, "x.example", port, "/"), LOOPBACK, b"{}", {}, timeout_s=5)
    assert answer == Answer(200, "y" * 2000)


@pytest.fixture(scope="module")
def certificate(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a file with the key and certificate of hooks.example.org, signed by itself."""
    if shutil.which("openssl") is None:
        pytest.skip("openssl is not installed; it makes the certificate")
    file = tmp_path_factory.mktemp("tls") / "both.pem"
    made = ["-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:P-256", "-nodes", "-keyout", str(file), "-out", str(file)]
    named = ["-subj", "/CN=hooks.example.org", "-addext", "subjectAltName=DNS:hooks.example.org", "-days", "2"]
    subprocess.run(["openssl", "req", "-x509", *made, *named], check=True, capture_output=True)
    return file


@pytest.fixture
def secure(certificate: Path) -> Iterator[Receiver]:
    receiver = Receiver()
    server = listening(receiver)
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
    context.load_cert_chain(certificate)
    server.socket = context.wrap_socket(server.socket, server_side=True)
    server.handle_error = lambda *_arguments: None  # type: ignore[method-assign]  # a refused handshake is no news
    with serving(server):
        yield receiver


def test_the_certificate_must_be_the_names_though_the_address_is_pinned(secure: Receiver, certificate: Path) -> None:
    trusting = ssl.create_default_context(cafile=str(certificate))
    right = Target(True, "hooks.example.org", secure.port, "/")
    assert post(right, LOOPBACK, b"{}", {}, context=trusting).status == 204
    wrong = Target(True, "other.example.org", secure.port, "/")
    with pytest.raises(NotAnswered, match="its certificate is not valid: Hostname mismatch"):
        post(wrong, LOOPBACK, b"{}", {}, context=trusting)
    with pytest.raises(NotAnswered, match="its certificate is not valid: self-signed certificate"):
        post(right, LOOPBACK, b"{}", {})
    assert len(secure.heard) == 1
