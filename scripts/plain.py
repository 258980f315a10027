"""Words that are fit for a terminal, as the programs print them (base/utf8.h)."""

import re
import sys

# Controls but line breaks and tabs, marks of direction, line and paragraph separators; and what UTF-8 cannot say.
UNFIT = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069\ud800-\udfff]")
NAMES = {"\r": "\\r"}


def escape(found):
    character = found[0]
    return "\ufffd" if "\ud800" <= character <= "\udfff" else NAMES.get(character, f"\\u{ord(character):04x}")


def plain(text):
    """The text, in which whatever moves the cursor, colours, hides or reverses text is an escape: \\u001b."""
    return UNFIT.sub(escape, text)


class PlainStream:
    """A stream that passes on what is fit."""

    def __init__(self, stream):
        self.stream = stream

    def write(self, text):
        self.stream.write(plain(text))
        return len(text)

    def __getattr__(self, name):
        return getattr(self.stream, name)


def fit_streams():
    """From now on all that is printed is fit for a terminal: names and reasons come from files."""
    sys.stdout, sys.stderr = PlainStream(sys.stdout), PlainStream(sys.stderr)
