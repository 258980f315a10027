"""What texts of the pictures are called instead (--label), and what was meant by a name that is not there."""

import difflib


def did_you_mean(word, names):
    """' (did you mean "NAME"?)', or '' if no name is near."""
    near = difflib.get_close_matches(word, list(names), 1)
    return f' (did you mean "{near[0]}"?)' if near else ""


class Wording:
    """The texts of pictures, and what is to stand in their place. A key is a text as it would stand there without it,
    in all pictures, or in one: PICTURE.TEXT."""

    def __init__(self, instead=None):
        self.instead = instead or {}
        self.picture = ""
        self.seen, self.used = {}, set()  # seen: in the order in which they came

    def begin(self, picture):
        """From now on texts are those of this picture."""
        self.picture = picture

    def of(self, text):
        self.seen[text] = self.seen[f"{self.picture}.{text}"] = None
        for key in (f"{self.picture}.{text}", text):
            if key in self.instead:
                self.used.add(key)
                return self.instead[key]
        return text

    def unused(self):
        """What to say of the first key that is no text of the pictures; '': all are."""
        for key in self.instead:
            if key not in self.used:
                return f"'{key}' is no text of the pictures{did_you_mean(key, self.seen)}"
        return ""
