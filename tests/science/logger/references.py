"""The decoder's compiled loops once more, slow and obvious."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from datetime import date

LENGTHS = {1: 11, 3: 6, 4: 7, 5: 6}
PRINTABLE = set(range(32, 127)) | {9, 10, 13}


@dataclass
class Scanned:
    """Packets as (offset, type, message), and damage as (offset, bytes skipped)."""

    packets: list[tuple[int, int, bytes]] = field(default_factory=list)
    resyncs: list[tuple[int, int]] = field(default_factory=list)


def packet_at(image: bytes, i: int) -> int | None:
    """End of the packet at ``i``, None when there is none."""
    if image[i : i + 1] != b"\xff" or i + 5 > len(image):
        return None
    kind, length = image[i + 1], image[i + 2]
    end = i + 3 + length
    if kind > 5 or length < 2 or length != LENGTHS.get(kind, length) or end > len(image):
        return None
    if sum(image[i + 2 : end - 1]) % 256 != image[end - 1]:
        return None
    if kind == 0 and not set(image[i + 3 : end - 1]) <= PRINTABLE:
        return None
    return end


def goes_on(image: bytes, end: int) -> bool:
    following = image[end : end + 2]
    return following == b"" or (following[0] == 0xFF and (len(following) == 1 or following[1] <= 5))


def accepted(image: bytes, i: int) -> int | None:
    """Like `packet_at`, but a packet nothing follows gives way to a better one that overlaps its end."""
    end = packet_at(image, i)
    if end is None or goes_on(image, end):
        return end
    for inner in range(i + 1, end):
        other = packet_at(image, inner)
        if other is not None and other > end and goes_on(image, other):
            return None
    return end


def scan(image: bytes) -> Scanned:
    found = Scanned()
    i, lost_at = 0, None
    while i <= len(image):
        end = accepted(image, i) if i < len(image) else len(image) + 1
        if end is None:
            lost_at = i if lost_at is None else lost_at
            i += 1
            continue
        if lost_at is not None:
            skipped = image[lost_at:i].rstrip(b"\0")
            if skipped:
                found.resyncs.append((lost_at, len(skipped)))
            lost_at = None
        if i < len(image):
            found.packets.append((i, image[i + 1], image[i + 3 : end - 1]))
        i = end
    return found


def signed_step(before: int, after: int) -> int:
    """Milliseconds from one 32-bit time stamp to another, the shorter way round."""
    step = (after - before) % 2**32
    return step - 2**32 if step >= 2**31 else step


@dataclass
class Clocked:
    """Per time stamp: (power-on, ms) or None when it isn't believed; and what happened to the clock."""

    times: list[tuple[int, int] | None] = field(default_factory=list)
    restarts: int = 0
    wraps: int = 0
    backward: int = 0


def follow_clock(stamps: list[int]) -> Clocked:
    done = Clocked()
    run, last, t = 0, None, 0
    for k, stamp in enumerate(stamps):
        in_order = last is not None and abs(signed_step(last, stamp)) <= 250
        if not in_order and not votes_for(stamps[k + 1 : k + 17], stamp, last):
            done.times.append(None)
            continue
        if last is None:
            t = stamp
        else:
            step = signed_step(last, stamp)
            if in_order or (step > 0 and stamp < last and step <= 3_600_000):
                t += step
                done.wraps += (stamp < last and step > 0) - (stamp > last and step < 0)
            elif stamp > last:
                t += stamp - last
            elif step >= -10_000 and stamp >= 5_000:
                done.backward += 1
            else:
                run, t = run + 1, stamp
                done.restarts += 1
        last = stamp
        done.times.append((run, t))
    return done


def votes_for(followers: list[int], stamp: int, last: int | None) -> bool:
    """Whether most of the time stamps behind go with this one rather than with the one before it."""
    if not followers:
        return last is None or 0 < signed_step(last, stamp) <= 60_000
    balance = 0
    for follower in followers:
        from_new = signed_step(stamp, follower)
        from_old = signed_step(last, follower) if last is not None else 10**9
        new, old = -250 <= from_new <= 60_000, -250 <= from_old <= 60_000
        if new and (not old or abs(from_new) <= abs(from_old)):
            balance += 1
        elif old:
            balance -= 1
    return balance > 0


SENTENCE = re.compile(rb"\$([0-9A-Z]{3,8})((?:,[ -#%-)+-~]*)?)\*([0-9A-Fa-f]{2})")
"""Address, fields, checksum; no dollar sign or star inside."""


def sentences(text: bytes) -> list[tuple[str, list[str]]]:
    """Address and fields of every sentence whose checksum is right."""
    found = []
    for match in SENTENCE.finditer(text):
        checksum = 0
        for byte in match[1] + match[2]:
            checksum ^= byte
        if checksum == int(match[3], 16):
            found.append((match[1].decode(), match[2].decode().split(",")))
    return found


def degrees(value: str, side: str, width: int) -> float:
    size = int(value[:width]) + float(value[width:]) / 60
    return -size if side in "SW" else size


def seconds_of_day(value: str) -> float:
    return 3600 * int(value[:2]) + 60 * int(value[2:4]) + float(value[4:])


def days_since_1970(value: str) -> int:
    year = int(value[4:])
    return (date(year + (1900 if year >= 80 else 2000), int(value[2:4]), int(value[:2])) - date(1970, 1, 1)).days
