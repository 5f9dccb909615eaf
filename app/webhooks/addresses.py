"""Where a webhook may lead: never to what only this server can reach, unless the settings say so."""

from __future__ import annotations

import ipaddress
import socket
from collections.abc import Callable
from dataclasses import dataclass
from ipaddress import IPv4Address, IPv6Address
from urllib.parse import urlsplit

from app.errors import Invalid
from app.settings import Settings, is_loopback_host

Address = IPv4Address | IPv6Address
Resolve = Callable[[str, int], list[Address]]

NAT64 = ipaddress.ip_network("64:ff9b::/96")


class OutOfReach(Exception):  # noqa: N818 - reads as what it says
    """A name leads nowhere, or where no webhook may go."""


@dataclass(frozen=True, slots=True)
class Target:
    """What a webhook's URL says: how to speak, with whom, and what to ask for there."""

    secure: bool
    host: str
    port: int
    path: str

    @property
    def authority(self) -> str:
        """Host and port as the ``Host`` header has them."""
        name = f"[{self.host}]" if ":" in self.host else self.host
        return name if self.port == (443 if self.secure else 80) else f"{name}:{self.port}"


@dataclass(frozen=True, slots=True)
class Reach:
    """How far webhooks may go beside public addresses over https: to this machine, to private networks."""

    loopback: bool = False
    private: bool = False

    @classmethod
    def of(cls, settings: Settings) -> Reach:
        """Return what the settings allow; the one person at this machine may send to it."""
        return cls(loopback=settings.is_loopback, private=settings.webhook_private)

    def allows(self, address: Address) -> bool:
        """Whether an address may be connected to."""
        inner = _embedded(address)
        if inner.is_multicast or inner.is_unspecified or inner.is_link_local:
            return False  # the last is where clouds keep their machines' keys
        if self.private or (self.loopback and inner.is_loopback):
            return True
        return inner.is_global and not inner.is_reserved


def _embedded(address: Address) -> Address:
    """Return the IPv4 address that an IPv6 one stands for, where it is of such a kind."""
    if isinstance(address, IPv4Address):
        return address
    if address in NAT64:
        return IPv4Address(int(address) & 0xFFFFFFFF)
    teredo = None if address.teredo is None else address.teredo[1]
    return address.ipv4_mapped or address.sixtofour or teredo or address


def parse_url(url: str, reach: Reach) -> Target:
    """Read a webhook's URL; raises `Invalid` for one that no webhook may have, whatever its name resolves to."""
    try:
        parts = urlsplit(url)
        host, port = parts.hostname or "", parts.port
        host.encode("idna")  # refuses names that no resolver would take
    except ValueError as error:
        raise _refused(f"{url!r} is not a URL.") from error
    if parts.scheme not in ("http", "https") or not host:
        raise _refused("Give a whole URL, such as https://example.org/ponthy.")
    if parts.username is not None or parts.password is not None:
        raise _refused("User name and password don't belong into the URL; check the signature instead.")
    if parts.fragment or not (url.isascii() and url.isprintable()) or " " in url:
        raise _refused("The URL has a fragment or letters that can't stand in one.")
    secure = parts.scheme == "https"
    if is_loopback_host(host) and not (reach.loopback or reach.private):
        raise _refused("A webhook can't lead back to this server.")
    if not secure and not (reach.private or is_loopback_host(host)):
        raise _refused("Use https; over plain http anybody on the way could read it.")
    literal = _literal(host)
    if literal is not None and not reach.allows(literal):
        raise _refused(f"{host} is not a public address. PONTHY_WEBHOOK_PRIVATE=true allows private ones.")
    path = (parts.path or "/") + (f"?{parts.query}" if parts.query else "")
    return Target(secure, host, port or (443 if secure else 80), path)


def addresses_of(target: Target, reach: Reach, resolve: Resolve | None = None) -> list[Address]:
    """Return the addresses of a target that may be connected to.

    Connect to one of these, not to the name: it could resolve to another one the next time.

    Raises
    ------
    OutOfReach
        When the name can't be resolved, or only to what must not be reached. Over plain http that is everything but
        this machine, unless private addresses are allowed.
    """
    try:
        found = (resolve or system_resolve)(target.host, target.port)
    except OSError as error:
        raise OutOfReach(f"the name {target.host} can't be resolved") from error
    allowed = [address for address in found if reach.allows(address)]
    if not target.secure and not reach.private:
        allowed = [address for address in allowed if _embedded(address).is_loopback]
    if not allowed:
        raise OutOfReach(f"{target.host} does not resolve to an address that webhooks may reach")
    return allowed


def system_resolve(host: str, port: int) -> list[Address]:
    """Return the addresses of a name, in the system's order and each once."""
    found = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)
    return list(dict.fromkeys(ipaddress.ip_address(str(entry[4][0]).partition("%")[0]) for entry in found))


def _literal(host: str) -> Address | None:
    try:
        return ipaddress.ip_address(host)
    except ValueError:
        return None  # a name; what it resolves to is looked at before each delivery


def _refused(message: str) -> Invalid:
    return Invalid("bad-webhook-url", message, field="url")
