"""Trips that several tests look at, and a reader of images written from the paper alone."""

from __future__ import annotations

import struct
from collections.abc import Callable
from functools import lru_cache

import pytest

from app.science.virtualcar.simulate import SimulatedTrip, simulate
from app.science.virtualcar.specification import RouteName, Simulation

Packet = tuple[int, bytes]


@pytest.fixture(scope="session")
def hour() -> Callable[[RouteName, int], SimulatedTrip]:
    """Return a function that gives an hour's trip by route and seed; each is simulated once."""

    @lru_cache(maxsize=8)
    def make(route: RouteName, seed: int) -> SimulatedTrip:
        return simulate(Simulation(duration_s=3600.0, route=route, seed=seed))

    return make


@pytest.fixture(scope="session")
def read_packets() -> Callable[[bytes], list[Packet]]:
    """Return a function that reads an image strictly (Sebesta 2010, App. C.1.4) into (type, message) pairs."""

    def read(image: bytes) -> list[Packet]:
        packets = []
        at = 0
        while at < len(image) and image[at] != 0:
            preamble, kind, length = struct.unpack_from("3B", image, at)
            assert preamble == 0xFF
            check = image[at + 2 + length]
            assert sum(image[at + 2 : at + 2 + length]) % 256 == check
            packets.append((kind, image[at + 3 : at + 2 + length]))
            at += 3 + length
        assert not any(image[at:])
        return packets

    return read
