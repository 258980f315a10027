"""Pictures as commands of PGF, which LaTeX typesets with \\input{paths.pgf}: in the letters of the document.

matplotlib asks a running LaTeX how wide each word is. Here words are as wide as in all other formats, so that no LaTeX is
needed: their places are the same, and each word is set from the side by which it is aligned.
"""

import re

from matplotlib.backends.backend_pgf import RendererPgf

ENDS = re.compile(r"(?<!\\)\$")  # of mathematics
SPECIAL = re.compile(r"[#&_{}]")  # for LaTeX, outside of mathematics; matplotlib takes care of % and ^
HEAD = """% In the preamble: \\usepackage{pgf}
% For the picture: \\input{NAME.pgf}
"""


def escaped(text):
    """The text with nothing in it, outside of mathematics, that LaTeX takes for a command."""
    parts = ENDS.split(text)
    parts[::2] = [SPECIAL.sub(lambda found: "\\" + found[0], part.replace("\\", "\\textbackslash ").replace(
        "~", "\\textasciitilde ")) for part in parts[::2]]
    return "$".join(parts)


class Renderer(RendererPgf):
    """Writes the commands of PGF to a file."""

    def __init__(self, figure, file):
        super().__init__(figure, file)
        self.measure = figure.canvas.get_renderer()

    def get_text_width_height_descent(self, s, prop, ismath):
        return self.measure.get_text_width_height_descent(s, prop, ismath)

    def draw_text(self, gc, x, y, s, prop, angle, ismath=False, mtext=None):
        super().draw_text(gc, x, y, escaped(s), prop, angle, ismath, mtext)


def write(figure, file):
    """Writes a picture to an open file of text."""
    for mesh in figure.findobj(lambda artist: artist.get_rasterized()):
        mesh.set_rasterized(False)  # those of a colour bar: an image would be a file of its own
    width, height = figure.get_size_inches()
    file.write(HEAD + "\\begingroup%\n\\makeatletter%\n\\begin{pgfpicture}%\n")
    file.write(f"\\pgfpathrectangle{{\\pgfpointorigin}}{{\\pgfqpoint{{{width:f}in}}{{{height:f}in}}}}%\n")
    file.write("\\pgfusepath{use as bounding box, clip}%\n")
    figure.draw(Renderer(figure, file))
    file.write("\\end{pgfpicture}%\n\\makeatother%\n\\endgroup%\n")
