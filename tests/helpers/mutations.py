"""Ways in which a file gets damaged: functions of a `random.Random` and the bytes."""

import gzip
import io
import lzma
import re
import struct
import zipfile

NUMBER = re.compile(rb"[-+]?\d+\.?\d*(?:[eE][-+]?\d+)?")
WORD = re.compile(rb"[A-Za-z_]{2,}")
NUMBERS = (b"nan", b"inf", b"-inf", b"1e308", b"-1e308", b"1e999", b"1e-320", b"-0", b"0", b"-1")
NUMBERS += (b"90", b"1_0", b"0x10", "٣".encode(), b"9" * 30, b"9" * 5000, b"1e", b"--1", b"1,5")
WORDS = (b"dark", b"null", b"None", b"true", b"{}", b"[", b'"', b"#", b"VARS", "θ".encode(), b"")
LENGTHS = (0, 1, -1, 4096, 4097, 2**31 - 1, -(2**31))
ENDS = (b"\n", b"\r\n", b"\r", b"\0", b"\x0b", b"\x0c", "\u2028".encode(), b"\n\n", b"")


def places(random, size):
    """Two positions in order, often near each other and near the head."""
    start = random.randrange(size + 1)
    if random.random() < 0.4:
        start = min(start, random.randrange(200))
    return start, min(size, start + random.choice((0, 1, 2, 4, 8, 64, size)))


def flip(random, data):
    data = bytearray(data)
    for _ in range(random.choice((1, 1, 2, 8))):
        if data:
            data[random.randrange(len(data))] ^= 1 << random.randrange(8)
    return bytes(data)


def overwrite(random, data):
    start, end = places(random, len(data))
    return data[:start] + random.randbytes(min(end - start, 64)) + data[end:]


def truncate(random, data):
    return data[: random.choice((random.randrange(len(data) + 1), max(0, len(data) - 1), 12))]


def extend(random, data):
    return data + random.choice((b"\0", b"\n", b"1 2 3\n", random.randbytes(30), data, data[-40:]))


def cut_out(random, data):
    start, end = places(random, len(data))
    return data[:start] + data[end:]


def repeat(random, data):
    start, end = places(random, len(data))
    return data[:end] + data[start:end] * random.choice((1, 2, 9)) + data[end:]


def swap_endianness(random, data):
    width, start = random.choice((2, 4, 8)), random.choice((0, 4, 12, random.randrange(64)))
    end = start + (len(data) - start) // width * width
    words = [data[i : i + width][::-1] for i in range(start, end, width)]
    return data[:start] + b"".join(words) + data[max(start, end) :]


def set_lengths(random, data):
    """Integers of the header become huge, negative or nothing."""
    data = bytearray(data.ljust(4, b"\0"))
    for _ in range(random.choice((1, 1, 3))):
        at = random.choice((0, 4, 8, random.randrange(max(1, min(len(data) - 4, 400)))))
        number = struct.pack(random.choice("<>") + "i", random.choice(LENGTHS))
        data[at : at + 4] = number
    return bytes(data)


def _replace(random, data, pattern, words):
    """One match, rather one among the first, becomes one of the words."""
    found = list(pattern.finditer(data[:20_000]))
    if not found:
        return data + random.choice(words)
    match = random.choice(found[: random.choice((5, 30, len(found)))])
    return data[: match.start()] + random.choice(words) + data[match.end() :]


def odd_number(random, data):
    return _replace(random, data, NUMBER, NUMBERS)


def text_for_number(random, data):
    return _replace(random, data, NUMBER, WORDS)


def number_for_text(random, data):
    return _replace(random, data, WORD, NUMBERS)


def text_for_text(random, data):
    return _replace(random, data, WORD, WORDS)


def line_ends(random, data):
    return data.replace(b"\r\n", b"\n").replace(b"\n", random.choice(ENDS))


def lines(random, data):
    """Lines go, come twice or change places."""
    found = data.split(b"\n")
    i, j = random.randrange(len(found)), random.randrange(len(found))
    what = random.randrange(4)
    if what == 0:
        del found[i]
    elif what == 1:
        found.insert(j, found[i])
    elif what == 2:
        found[i], found[j] = found[j], found[i]
    else:
        found[i] = (
            b" ".join(random.sample(parts, len(parts))) if (parts := found[i].split()) else b""
        )
    return b"\n".join(found)


def nul_bytes(random, data):
    start, _ = places(random, len(data))
    return data[:start] + b"\0" * random.choice((1, 8, 500)) + data[start:]


def byte_order_mark(random, data):
    if random.random() < 0.5:
        return b"\xef\xbb\xbf" + data
    text = data.decode("latin-1")
    return text.encode(random.choice(("utf-16", "utf-16-be", "utf-32", "utf-8", "utf-7")))


def nothing(random, data):
    return random.choice((b"", b"\n", b" \t\r\n", b"#", b"\0", b"\xff" * 20, data[:1] * 50))


def damage_gzip(random, data):
    return random.choice((flip, truncate, extend, cut_out))(random, gzip.compress(data, 1))


def damage_xz(random, data):
    return random.choice((flip, truncate, extend, cut_out))(random, lzma.compress(data, preset=0))


def damage_member(random, data):
    """One member of a zip archive is damaged, its checksum is right; else two damages at once."""
    inner = random.choice(ANYWHERE)
    if not data.startswith(b"PK"):
        return inner(random, random.choice(ANYWHERE)(random, data))
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        members = {info.filename: archive.read(info) for info in archive.infolist()}
    name = random.choice(list(members))
    members[name] = inner(random, members[name])
    if random.random() < 0.2:
        del members[random.choice(list(members))]
    how = random.choice((zipfile.ZIP_STORED,) * 9 + (zipfile.ZIP_DEFLATED,))
    with zipfile.ZipFile(stream := io.BytesIO(), "w", how) as archive:
        for name, content in members.items():
            archive.writestr(name, content)
    return stream.getvalue()


ANYWHERE = (flip, overwrite, truncate, extend, cut_out, repeat, swap_endianness, set_lengths)
ANYWHERE += (odd_number, text_for_number, number_for_text, text_for_text)
EVERY = (*ANYWHERE, line_ends, lines, nul_bytes, byte_order_mark, nothing)
EVERY += (damage_gzip, damage_xz, damage_member)
