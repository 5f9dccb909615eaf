"""Compiled loop over receiver text: sentences to numbers."""

from __future__ import annotations

import numpy as np

from app.science.arrays import AnyArray, FloatArray, IntArray
from app.science.jit import kernel

GGA, RMC, GSA, VTG = 1, 2, 3, 4
"""Sentences whose numbers are used."""

TIME_OF_DAY, DAY, LAT, LON, ALT, HDOP, SATELLITES, QUALITY, SPEED, COURSE = range(10)
VALUES = 10
"""Columns of a sentence's values; NaN where the sentence doesn't say."""

LETTERS = 26
TYPES = LETTERS**3
OTHER_TYPE = 2 * TYPES
TYPE_BINS = OTHER_TYPE + 1
"""Bins of sentence counts: by the three letters of the type, by maker for proprietary ones, all others."""

SENTENCES, ROWS, BAD_CHECKSUMS, MALFORMED, NO_FIX = range(5)
COUNTS = 5

LONGEST_SENTENCE = 255
LONGEST_ADDRESS = 8
MOST_FIELDS = 40
MPS_PER_KNOT = 1852.0 / 3600.0
NAN = np.nan
MOST_DIGITS = 18
POWERS = 10.0 ** np.arange(MOST_DIGITS + 1)

DOLLAR, STAR, COMMA, POINT, MINUS, ZERO, SIXTY, NINE = (ord(sign) for sign in "$*,.-069")
A, E, N, P, S, W, Z, LOWER_A = (ord(sign) for sign in "AENPSWZa")

INSIDE, SEPARATOR, END = range(3)
ROLE = np.full(256, END, np.uint8)
"""What a byte is to the inside of a sentence: anything but printable characters ends it, as do its two signs."""
ROLE[32:127] = INSIDE
ROLE[COMMA] = SEPARATOR
ROLE[[DOLLAR, STAR]] = END


@kernel
def number(text: AnyArray, begin: int, end: int) -> float:
    """Read a plain decimal number; NaN when empty or anything else."""
    i = begin
    negative = i < end and text[i] == MINUS
    if negative:
        i += 1
    digits, decimals, mantissa = 0, 0, 0
    point = False
    while i < end:
        byte = int(text[i])
        if byte == POINT and not point:
            point = True
        elif ZERO <= byte <= NINE and digits < MOST_DIGITS:
            mantissa = 10 * mantissa + byte - ZERO
            digits += 1
            decimals += point
        else:
            return NAN
        i += 1
    if digits == 0:
        return NAN
    value = float(mantissa / POWERS[decimals])
    return -value if negative else value


@kernel
def pair(text: AnyArray, i: int) -> int:
    """Read two decimal digits, or -1."""
    tens, ones = int(text[i]) - ZERO, int(text[i + 1]) - ZERO
    return 10 * tens + ones if 0 <= tens <= 9 and 0 <= ones <= 9 else -1


@kernel
def time_of_day(text: AnyArray, begin: int, end: int) -> float:
    """Read ``hhmmss.sss`` as seconds of the day."""
    if end - begin < 6:
        return NAN
    hours, minutes = pair(text, begin), pair(text, begin + 2)
    seconds = number(text, begin + 4, end)
    if not (0 <= hours < 24 and 0 <= minutes < 60 and 0.0 <= seconds < 61.0):
        return NAN
    return 3600 * hours + 60 * minutes + seconds


@kernel
def day_number(text: AnyArray, begin: int, end: int) -> float:
    """Read ``ddmmyy`` as days since 1970-01-01; two-digit years from 80 on are the 1900s."""
    if end - begin != 6:
        return NAN
    day, month, year = pair(text, begin), pair(text, begin + 2), pair(text, begin + 4)
    if not (1 <= day <= 31 and 1 <= month <= 12 and year >= 0):
        return NAN
    year += 1900 if year >= 80 else 2000
    # days from the civil calendar, the year beginning in March so that the leap day comes last
    shifted = year - (month <= 2)
    day_of_year = (153 * ((month + 9) % 12) + 2) // 5 + day - 1
    return 365.0 * shifted + shifted // 4 - shifted // 100 + shifted // 400 + day_of_year - 719468


@kernel
def angle(text: AnyArray, begin: int, end: int, side: int, positive: int, negative: int, limit: int) -> float:
    """Read ``dddmm.mmmm`` and its hemisphere letter as degrees."""
    point = begin
    while point < end and text[point] != POINT:
        point += 1
    if point - begin < 3 or (side != positive and side != negative):
        return NAN
    value = number(text, begin, point - 2) + number(text, point - 2, end) / 60.0
    if not (0.0 <= value <= limit and text[point - 2] < SIXTY):
        return NAN
    return value if side == positive else -value


@kernel
def type_bin(text: AnyArray, begin: int, end: int) -> int:
    """Return the counting bin of an address such as ``GPGGA`` or ``PMTK001``."""
    proprietary = text[begin] == P
    first = begin + 1 if proprietary else begin + 2
    if first + 3 > end or (not proprietary and first + 3 != end):
        return OTHER_TYPE
    key = 0
    for i in range(first, first + 3):
        if not A <= text[i] <= Z:
            return OTHER_TYPE
        key = LETTERS * key + int(text[i]) - A
    return key + TYPES if proprietary else key


def letters_bin(letters: str) -> int:
    """Return the counting bin of a standard type's three letters."""
    first, second, third = (ord(sign) - A for sign in letters)
    return (first * LETTERS + second) * LETTERS + third


GGA_BIN, RMC_BIN, GSA_BIN, VTG_BIN = (letters_bin(letters) for letters in ("GGA", "RMC", "GSA", "VTG"))


@kernel
def hex_digit(byte: int) -> int:
    """Return the value of a hexadecimal digit, or -1."""
    if ZERO <= byte <= NINE:
        return byte - ZERO
    upper = byte - 32 if byte >= LOWER_A else byte
    return upper - A + 10 if A <= upper <= A + 5 else -1


@kernel
def letter(text: AnyArray, field: IntArray, count: int, index: int) -> int:
    """Return the only character of a field, or 0."""
    if index < count and field[index + 1] - 1 - field[index] == 1:
        return int(text[field[index]])
    return 0


@kernel
def field_number(text: AnyArray, field: IntArray, count: int, index: int) -> float:
    """Return a field as a number, NaN when the sentence is shorter."""
    return number(text, field[index], field[index + 1] - 1) if index < count else NAN


@kernel
def fill_position(text: AnyArray, field: IntArray, count: int, index: int, row: FloatArray) -> bool:
    """Fill latitude and longitude from four fields; False when they are there but make no sense."""
    if index + 3 >= count or field[index + 1] - 1 == field[index]:
        return True
    lat_side, lon_side = letter(text, field, count, index + 1), letter(text, field, count, index + 3)
    row[LAT] = angle(text, field[index], field[index + 1] - 1, lat_side, N, S, 90)
    row[LON] = angle(text, field[index + 2], field[index + 3] - 1, lon_side, E, W, 180)
    return bool(np.isfinite(row[LAT]) and np.isfinite(row[LON]))


@kernel
def fill_values(text: AnyArray, field: IntArray, count: int, key: int, row: FloatArray) -> int:
    """Fill one row from a sentence whose checksum is right; return its kind, 0 if unused, -1 if senseless."""
    row[:] = NAN
    if key == GGA_BIN:
        if count < 10:
            return -1
        row[TIME_OF_DAY] = time_of_day(text, field[1], field[2] - 1)
        row[QUALITY] = field_number(text, field, count, 6)
        row[SATELLITES] = field_number(text, field, count, 7)
        row[HDOP] = field_number(text, field, count, 8)
        row[ALT] = field_number(text, field, count, 9)
        return GGA if fill_position(text, field, count, 2, row) else -1
    if key == RMC_BIN:
        if count < 10:
            return -1
        row[TIME_OF_DAY] = time_of_day(text, field[1], field[2] - 1)
        mode = letter(text, field, count, 12)
        row[QUALITY] = 1.0 if letter(text, field, count, 2) == A and mode != N else 0.0
        row[SPEED] = field_number(text, field, count, 7) * MPS_PER_KNOT
        row[COURSE] = field_number(text, field, count, 8)
        row[DAY] = day_number(text, field[9], field[10] - 1)
        return RMC if fill_position(text, field, count, 3, row) else -1
    if key == GSA_BIN:
        row[HDOP] = field_number(text, field, count, 16)
        return GSA if count >= 18 else -1
    if key == VTG_BIN:
        if count < 9:
            return -1
        row[COURSE] = field_number(text, field, count, 1)
        row[SPEED] = field_number(text, field, count, 5) * MPS_PER_KNOT
        if np.isnan(row[SPEED]):
            row[SPEED] = field_number(text, field, count, 7) / 3.6
        return VTG if letter(text, field, count, 9) != N else 0
    return 0


@kernel
def read_sentences(
    text: AnyArray, kind: AnyArray, start: IntArray, values: FloatArray, bins: IntArray, counts: IntArray
) -> int:
    """Read every complete sentence of receiver text, whatever stands between them.

    Parameters
    ----------
    text : array of uint8, shape (n,)
    kind, start, values : arrays, shapes (m,), (m,), (m, VALUES)
        Filled per GGA, RMC, GSA or VTG: which, index of its dollar sign, its numbers.
    bins : array, shape (TYPE_BINS,)
        Counts of sentences whose checksum is right, by type; added to.
    counts : array, shape (COUNTS,)
        Added to.

    Returns
    -------
    int
        Number of bytes dealt with: an unfinished sentence at the end belongs in front of the next text.
    """
    stop = len(text)
    field = np.empty(MOST_FIELDS + 2, np.int64)
    i = 0
    while i < stop:
        if text[i] != DOLLAR:
            i += 1
            continue
        k = i + 1
        while k < stop and (ZERO <= text[k] <= NINE or A <= text[k] <= Z) and k - i <= LONGEST_ADDRESS:
            k += 1
        if k == stop:
            return i
        if k - i < 4 or (text[k] != COMMA and text[k] != STAR):
            i += 1  # a dollar sign in other bytes
            continue
        address_end = k
        checksum = 0
        for j in range(i + 1, k):
            checksum ^= text[j]
        field[0] = i + 1
        count = 1
        limit = min(stop, i + LONGEST_SENTENCE)
        while k < limit:
            byte = text[k]
            role = ROLE[byte]
            if role == END:
                break
            checksum ^= byte
            k += 1
            if role == SEPARATOR and count <= MOST_FIELDS:
                field[count] = k
                count += 1
        if k == stop or (text[k] == STAR and k + 2 >= stop):
            return i
        if text[k] != STAR:
            counts[MALFORMED] += 1
            i = k
            continue
        field[count] = k + 1
        high, low = hex_digit(text[k + 1]), hex_digit(text[k + 2])
        if high < 0 or low < 0:
            counts[MALFORMED] += 1
            i = k + 1
            continue
        if 16 * high + low != checksum:
            counts[BAD_CHECKSUMS] += 1
            i = k + 1
            continue
        i_next = k + 3
        counts[SENTENCES] += 1
        key = type_bin(text, i + 1, address_end)
        bins[key] += 1
        row = counts[ROWS]
        used = fill_values(text, field, count, key, values[row])
        if used < 0:
            counts[MALFORMED] += 1
        elif used > 0:
            kind[row], start[row] = used, i
            counts[NO_FIX] += (used in (GGA, RMC)) and not values[row, QUALITY] > 0.0
            counts[ROWS] += 1
        i = i_next
    return stop
