#!/usr/bin/env python3
"""Completes the header of an image that was linked: length, checksum and hash of the body, checksum of the header
(shared/image/image_header.hpp). The header is written to a file of its own, too.

usage: complete_image.py IMAGE HEADER
"""

import hashlib
import pathlib
import struct
import sys
import zlib

HEADER_SIZE = 512


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    image = pathlib.Path(sys.argv[1])
    content = image.read_bytes()
    header, body = bytearray(content[:HEADER_SIZE]), content[HEADER_SIZE:]
    if len(header) < HEADER_SIZE or not body or len(body) % 4 != 0:
        sys.exit(f"{image}: found {len(content)} bytes, expected a header of {HEADER_SIZE} and words behind it")
    struct.pack_into("<II", header, 32, len(body), zlib.crc32(body))
    header[64:96] = hashlib.sha256(body).digest()
    struct.pack_into("<I", header, HEADER_SIZE - 4, zlib.crc32(header[:HEADER_SIZE - 4]))
    image.write_bytes(header + body)
    pathlib.Path(sys.argv[2]).write_bytes(header)


if __name__ == "__main__":
    main()
