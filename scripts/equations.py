"""Equations set in type while a page is built, so that it shows them without a script and without a network.

In Markdown, an equation is a block ```math, or $`...`$ within a line, as GitHub has them. mkdocs calls on_post_page() for
each page (`hooks` in mkdocs.yml); scripts/handout calls typeset().
"""

import html
import json
import pathlib
import re
import subprocess

KATEX = pathlib.Path("/usr/share/javascript/katex")  # Debian's libjs-katex; its style and letters are beside its program
BY = pathlib.Path(__file__).with_name("equations.mjs")
EQUATION = re.compile(r'<pre class="math"><code>(?P<display>.*?)</code></pre>|\$<code>(?P<inline>.*?)</code>\$(?P<mark>[.,;:)]*)',
                      re.S)
SHORT = 40  # letters of TeX: such an equation stays in one line with the mark behind it


class BadEquation(Exception):
    pass


def typeset(equations):
    """The HTML of each (TeX, whether it stands on lines of its own). Raises BadEquation for one that is not TeX."""
    asked = json.dumps([{"tex": tex, "display": display} for tex, display in equations])
    done = subprocess.run(["node", BY], input=asked, capture_output=True, text=True)
    if done.returncode != 0:
        raise BadEquation(done.stderr.strip())
    return json.loads(done.stdout)


def with_equations(page):
    """The HTML of a page, in which Markdown left equations as code, with these set in type."""
    found = [match.groupdict() for match in EQUATION.finditer(page)]
    if not found:
        return page
    done = iter(typeset([(html.unescape(one["display"] or one["inline"]), one["display"] is not None) for one in found]))
    return EQUATION.sub(lambda match: with_mark(next(done), match), page)


def with_mark(equation, match):
    if match["inline"] is None:
        return equation
    equation, mark = equation.replace("\xa0", " "), match["mark"]  # words break between spaces, where the style lets them
    if mark and len(match["inline"]) < SHORT:
        return f'<span style="white-space: nowrap">{equation}{mark}</span>'
    return equation + mark


def on_post_page(output, page, config):
    from mkdocs.exceptions import PluginError
    try:
        return with_equations(output)
    except BadEquation as error:
        raise PluginError(f"{page.file.src_path}: {error}") from error
