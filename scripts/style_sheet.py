"""Style sheets of matplotlib (--style): a file of theirs, or one of the styles that matplotlib brings along."""

import pathlib
import re
import shutil

import matplotlib.style
from regular_file import open_regular
from wording import did_you_mean

ENDING = ".mplstyle"
ENTRY = re.compile(r'((?:[^"#]|"[^"]*")*)')  # what is in front of a comment; in quotes # is that of a colour
# What says how matplotlib runs and not how pictures look, and what keeps the bytes of a picture the same.
NOT_OF_A_STYLE = {*matplotlib.style.core.STYLE_BLACKLIST, "svg.hashsalt"}


class StyleError(Exception):
    """What is wrong with a style sheet, and where."""


def names():
    return [name for name in matplotlib.style.available if not name.startswith("_")]


def read(text):
    """The settings of the style that an option names."""
    if text in matplotlib.style.library:
        return dict(matplotlib.style.library[text])
    path = pathlib.Path(text)
    if path.suffix == ENDING or "/" in text:
        return read_file(path)
    raise StyleError(f"--style: expected a file FILE{ENDING} or a style of matplotlib ({', '.join(names())}), got '{text}'"
                     f"{did_you_mean(text, names())}")


def read_file(path):
    settings = {}
    try:
        with open_regular(path, encoding="utf-8") as file:
            for number, line in enumerate(file, 1):
                if entry := ENTRY.match(line)[1].strip():
                    key, value = checked(f"{path}:{number}", entry)
                    settings[key] = value
    except OSError as error:
        raise StyleError(f"{path}: {'no such file' if isinstance(error, FileNotFoundError) else error.strerror}") from None
    except UnicodeDecodeError:
        raise StyleError(f"{path}: it is no text in UTF-8") from None
    return settings


def checked(where, entry):
    """Key and value of a line, the value as matplotlib has it."""
    key, colon, value = (part.strip() for part in entry.partition(":"))
    value = value[1:-1] if len(value) > 1 and value[0] == value[-1] == '"' else value
    if not colon:
        raise StyleError(f"{where}: expected KEY: VALUE, got '{entry}'")
    keys = matplotlib.rcParams.validate
    if key not in keys:
        raise StyleError(f"{where}: {key}: unknown key{did_you_mean(key, keys)}")
    if key in NOT_OF_A_STYLE:
        raise StyleError(f"{where}: {key}: it says nothing about how a picture looks")
    try:
        value = keys[key](value)
    except (ValueError, TypeError, KeyError) as error:
        raise StyleError(f"{where}: {key}: matplotlib takes no '{value}': {error}") from None
    if key == "text.usetex" and value and not shutil.which("latex"):
        raise StyleError(f"{where}: {key}: it needs the program latex, which is not installed "
                         "(Debian: apt-get install texlive-latex-extra cm-super dvipng)")
    return key, value
