"""Writes the image of a figure: a plus sign that is not transparent. figure.py FILE.png"""
import struct
import sys
import zlib

SIZE = 60


def chunk(kind, data):
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def row(y):
    inside = lambda x: 20 <= x < 40 or 20 <= y < 40
    return b"\0" + b"".join(b"\xc0\x40\x20\xff" if inside(x) else b"\0" * 4 for x in range(SIZE))


with open(sys.argv[1], "wb") as file:
    file.write(b"\x89PNG\r\n\x1a\n")
    file.write(chunk(b"IHDR", struct.pack(">IIBBBBB", SIZE, SIZE, 8, 6, 0, 0, 0)))
    file.write(chunk(b"IDAT", zlib.compress(b"".join(row(y) for y in range(SIZE)))))
    file.write(chunk(b"IEND", b""))
