"""Loads matplotlib so that a picture depends on nothing but what it shows: not on the user's home, environment, fonts or
matplotlibrc. Imported before everything that needs matplotlib or NumPy.
"""

import contextlib
import os
import sys
import tempfile

# Read by matplotlib, by NumPy and by what it computes with.
NOT_OURS = ("MATPLOTLIBRC", "MPLBACKEND", "MPLSETUPCFG", "NPY_DISABLE_CPU_FEATURES", "NPY_PROMOTION_STATE",
            "OPENBLAS_CORETYPE")


@contextlib.contextmanager
def elsewhere():
    """In a folder of its own, which is removed: matplotlib reads a matplotlibrc of the current folder, and keeps files in
    the folder that MPLCONFIGDIR names."""
    try:
        here = os.open(".", os.O_PATH | os.O_DIRECTORY | os.O_CLOEXEC)
    except PermissionError:  # then nobody can read a file in it, either
        here = None
    with tempfile.TemporaryDirectory(prefix="mascot-") as folder:
        os.environ["MPLCONFIGDIR"] = folder
        if here is not None:
            os.chdir(folder)
        try:
            yield
        finally:
            if here is not None:
                os.fchdir(here)
                os.close(here)
            del os.environ["MPLCONFIGDIR"]


@contextlib.contextmanager
def no_fonts_but(data):
    """matplotlib looks for fonts in all folders of the system and of the user. One of the same name may be another there,
    and a look at all of them takes seconds."""
    walk, path = os.walk, os.environ.get("PATH")
    os.walk = lambda top, *args, **words: walk(top, *args, **words) if os.fspath(top).startswith(data) else iter(())
    os.environ["PATH"] = ""  # no fc-list
    try:
        yield
    finally:
        os.walk = walk
        if path is None:
            del os.environ["PATH"]
        else:
            os.environ["PATH"] = path


def load():
    for name in NOT_OURS:
        os.environ.pop(name, None)
    config = os.environ.get("MPLCONFIGDIR")
    with elsewhere():
        import matplotlib
        with no_fonts_but(matplotlib.get_data_path()):
            import matplotlib.font_manager
        matplotlib.use("Agg")
        import matplotlib.pyplot
    if config is not None:
        os.environ["MPLCONFIGDIR"] = config


try:
    load()
except ImportError as error:
    print(f"error: pictures need matplotlib and NumPy (Debian: apt-get install python3-matplotlib): {error}",
          file=sys.stderr)
    sys.exit(1)
except OSError as error:
    print(f"error: matplotlib cannot be loaded: {error.strerror}: {error.filename}", file=sys.stderr)
    sys.exit(1)
