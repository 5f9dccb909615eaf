"""Where a webhook may lead, by its URL and by what its name resolves to."""

from __future__ import annotations

from ipaddress import ip_address

import pytest

from app.errors import Invalid
from app.webhooks.addresses import OutOfReach, Reach, Target, addresses_of, parse_url

PUBLIC, HERE, ANYWHERE = Reach(), Reach(loopback=True), Reach(private=True)


def test_a_url_is_taken_apart() -> None:
    assert parse_url("https://example.org/a/b?c=1", PUBLIC) == Target(True, "example.org", 443, "/a/b?c=1")
    assert parse_url("https://example.org:8443", PUBLIC) == Target(True, "example.org", 8443, "/")
    assert parse_url("http://[::1]:80/x", HERE).authority == "[::1]"
    assert parse_url("https://example.org:8443", PUBLIC).authority == "example.org:8443"


@pytest.mark.parametrize(
    "url",
    [
        "example.org",
        "ftp://example.org",
        "https://",
        "https://me:word@example.org/",
        "https://example.org/#part",
        "https://example.org/a b",
        "https://example.org/\r\nX: y",
        "https://exämple.org/",
        "https://example.org:99999/",
        "https://[::1/",
        "https://" + "a" * 64 + ".org/",
        "http://example.org/",
        "https://localhost/",
        "https://127.0.0.1/",
        "https://10.0.0.1/",
        "https://169.254.169.254/latest/meta-data",
        "https://[::ffff:10.0.0.1]/",
        "https://[fd00::1]/",
        "https://0.0.0.0/",
    ],
)
def test_a_url_that_no_webhook_may_have_is_refused_with_a_reason(url: str) -> None:
    with pytest.raises(Invalid) as refused:
        parse_url(url, PUBLIC)
    assert refused.value.code == "bad-webhook-url"
    assert refused.value.message.endswith(".")


def test_the_one_person_at_this_machine_may_send_to_it_but_not_into_the_network() -> None:
    assert parse_url("http://localhost:9000/x", HERE).port == 9000
    for url in ("http://192.168.1.4/", "https://192.168.1.4/", "http://example.org/"):
        with pytest.raises(Invalid):
            parse_url(url, HERE)
        parse_url(url, ANYWHERE)


@pytest.mark.parametrize(
    ("address", "public"),
    [
        ("93.184.216.34", True),
        ("2606:2800:220:1::1", True),
        ("127.0.0.1", False),
        ("::1", False),
        ("10.1.2.3", False),
        ("172.16.0.1", False),
        ("192.168.0.1", False),
        ("100.64.0.1", False),
        ("169.254.169.254", False),
        ("0.0.0.0", False),  # noqa: S104 - an address to be refused
        ("224.0.0.1", False),
        ("255.255.255.255", False),
        ("::", False),
        ("fe80::1", False),
        ("fd12::1", False),
        ("::ffff:127.0.0.1", False),
        ("::ffff:93.184.216.34", True),
        ("64:ff9b::a00:1", False),  # 10.0.0.1 behind a translator
        ("2002:a00:1::", False),  # 10.0.0.1 behind a 6to4 relay
    ],
)
def test_only_public_addresses_are_reached(address: str, public: bool) -> None:
    assert PUBLIC.allows(ip_address(address)) is public


def test_even_private_networks_do_not_hold_the_clouds_keys() -> None:
    assert ANYWHERE.allows(ip_address("10.0.0.1"))
    assert not ANYWHERE.allows(ip_address("169.254.169.254"))


def test_of_a_names_addresses_the_allowed_ones_are_connected_to() -> None:
    found = [ip_address(text) for text in ("10.0.0.1", "93.184.216.34", "127.0.0.1")]
    target = Target(True, "example.org", 443, "/")
    assert addresses_of(target, PUBLIC, lambda _host, _port: found) == [ip_address("93.184.216.34")]
    with pytest.raises(OutOfReach, match=r"example\.org does not resolve to an address that webhooks may reach"):
        addresses_of(target, PUBLIC, lambda _host, _port: found[:1])


def test_plain_http_stays_on_this_machine_whatever_the_name_resolves_to() -> None:
    target = Target(False, "localhost", 80, "/")
    public = [ip_address("93.184.216.34")]
    with pytest.raises(OutOfReach):
        addresses_of(target, HERE, lambda _host, _port: public)
    assert addresses_of(target, ANYWHERE, lambda _host, _port: public) == public


def test_a_name_that_is_nobodys_is_said_so() -> None:
    def nobody(_host: str, _port: int) -> list[object]:
        raise OSError("Name or service not known")

    with pytest.raises(OutOfReach, match=r"the name nobody\.invalid can't be resolved"):
        addresses_of(Target(True, "nobody.invalid", 443, "/"), PUBLIC, nobody)  # type: ignore[arg-type]
