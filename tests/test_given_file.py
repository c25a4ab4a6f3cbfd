"""What stands in a given file is read as it is, on every system."""

import os

from canon.given_file import bytes_of

EVERY_BYTE = bytes(range(256)) + b"\r\n\x1a after Ctrl-Z\n"


def test_every_byte_is_read(tmp_path):
    file = tmp_path / "every"
    file.write_bytes(EVERY_BYTE)
    assert bytes_of(file, 1000, "split it") == EVERY_BYTE


def test_windows_is_asked_for_the_bytes_as_they_are(tmp_path, monkeypatch):
    """Without O_BINARY it ends a file at its first Ctrl-Z: claims behind it would be lost without a word."""
    binary, given, opened = 1 << 30, [], os.open
    monkeypatch.setattr(os, "O_BINARY", binary, raising=False)
    monkeypatch.setattr(os, "open", lambda path, flags: given.append(flags) or opened(path, flags & ~binary))
    file = tmp_path / "every"
    file.write_bytes(EVERY_BYTE)
    assert bytes_of(file, 1000, "split it") == EVERY_BYTE
    assert given[0] & binary
