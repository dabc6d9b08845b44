"""No page of the validation holds a measured number that was typed by hand.

The texts stand in the strings of validation/*.py and validation/paper/*.py and in the templates validation/*.md.in.
What the runs measure comes into them as {values} and @values@. Every other number must be known to typed_numbers.toml,
which tells of each what it is: a setting, what was asked for, an identity or a reference with its key.
"""
import ast
import re
import unittest
from pathlib import Path

try:
    import tomllib
except ImportError as missing:  # Python before 3.11
    raise unittest.SkipTest("the Python package tomllib is missing") from missing

ROOT = Path(__file__).resolve().parents[2]
ALLOWED = Path(__file__).with_name("typed_numbers.toml")
# Scripts that make no pages.
NO_PAGES = ("common.py", "hostile.py")
KINDS = ("setting", "asked", "identity", "reference")

FRACTIONS = r"thirds?|quarters?|fifths?|tenths?"
COUNTS = r"two|three|four|five|six|seven|eight|nine|ten|twelve"
# Numbers that look like results: parts and factors, values in units that decks rarely give in prose, and decimals.
NUMBER = re.compile(
    r"\d[\d.,]*(?: (?:to|and) [-+]?[\d.]+)? ?(?:%|per cent)|"
    r"\d[\d.,]*(?:-fold| times)\b|"
    r"\d[\d.,]*(?: to [\d.]+)? ?(?:[kMG]?Pa(?: s)?|N s|[kM]?J(?:/kg)?|k?m/s|kN|MN)\b|"
    r"(?<![\w.])\d+\.\d+\b|"
    rf"\b(?:twice|(?:{COUNTS})fold|(?:{COUNTS}) times|(?:a|an|one|{COUNTS}) (?:{FRACTIONS}))\b", re.IGNORECASE)
# What is no measurement: code, keys and places of references, `name = value`, versions.
NO_NUMBERS = re.compile(
    r"<code>.*?</code>|`[^`]*`|\w+\.toml|\[[A-Z][A-Za-z]*\d+[a-z]?\]|"
    r"\b(?:Fig|Table|Eq|[Ee]xample|[Cc]ase)s?\.? \(?[\d.]+\)?|[\w*'γ] >?= [\d.]+\d(?! ?%)|@\w+@|\{\}", re.DOTALL)


def is_deck(text):
    """Lines of a deck, which are settings by nature: a head of a table alone in its line, or `key = value`."""
    lines = re.search(r"^\[+[a-z_.]+\]+$|^[a-z_.]+ ?= ?[\"\[{\d]", text, re.MULTILINE)
    return text.startswith("=") or (lines is not None and "<p>" not in text)


def text_of(node):
    """A string of the program, values as {}; None of what is no string."""
    if isinstance(node, ast.Constant) and isinstance(node.value, str):
        return node.value
    if isinstance(node, ast.JoinedStr):
        return "".join(part.value if isinstance(part, ast.Constant) else "{}" for part in node.values)
    return None


def strings_of(path):
    """The strings of a script that may come into a page: neither documentation of code nor decks nor messages."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    out, skipped = [], set()
    for node in ast.walk(tree):
        if isinstance(node, (ast.Module, ast.FunctionDef, ast.ClassDef)) and ast.get_docstring(node):
            skipped.add(id(node.body[0].value))
        called = node.func if isinstance(node, ast.Call) else None
        name = getattr(called, "attr", getattr(called, "id", ""))
        if name in ("print", "exit", "compile", "sub", "split", "search", "fullmatch", "add_argument"):
            skipped.update(id(part) for argument in node.args for part in ast.walk(argument))
        if isinstance(node, ast.JoinedStr):
            skipped.update(id(part) for part in node.values)
    for node in ast.walk(tree):
        text = None if id(node) in skipped else text_of(node)
        if text and not is_deck(text) and len(re.findall(r"[A-Za-z]{2,}", text)) >= 3:
            out.append(text)
    return out


def texts():
    """{file: texts that come into its page}."""
    scripts = [p for p in (*(ROOT / "validation").glob("*.py"), *(ROOT / "validation" / "paper").glob("*.py"))
               if p.name not in NO_PAGES]
    found = {p: strings_of(p) for p in scripts}
    found |= {p: [p.read_text(encoding="utf-8")] for p in (ROOT / "validation").glob("*.md.in")}
    return {p.relative_to(ROOT / "validation").as_posix(): t for p, t in sorted(found.items())}


def flat(text):
    return " ".join(text.split())


def typed(strings, phrases):
    """Numbers in texts, but for those in allowed phrases; each with the words around it."""
    found = []
    for text in map(flat, strings):
        for phrase in phrases:
            text = text.replace(flat(phrase), " ")
        shown = NO_NUMBERS.sub(" ", text)
        found += [f"{number.strip()!r} in: ... {shown[max(0, at - 50):at + 40].strip()} ..."
                  for number, at in ((m.group(), m.start()) for m in NUMBER.finditer(shown))]
    return found


class Numbers(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.texts = texts()
        cls.allowed = tomllib.loads(ALLOWED.read_text(encoding="utf-8"))

    def phrases(self, name):
        return [phrase for phrases in self.allowed.get(name, {}).values() for phrase in phrases]

    def test_texts_are_found(self):
        self.assertGreater(len(self.texts), 20)
        known = {"paper/plates.py": "Whoever scales meets both tests", "rupture.py": "quasi-steady orifice",
                 "points.md.in": "Linear shape functions", "paper/sod.py": "What is left between the gas",
                 "confined.py": "A closed box of steel", "matrix.py": "Limited faces: fluxes"}
        for name, words in known.items():
            self.assertTrue(any(words in flat(text) for text in self.texts[name]), name)

    def test_no_measured_number_is_typed(self):
        self.maxDiff = None
        found = {name: typed(strings, self.phrases(name)) for name, strings in self.texts.items()}
        self.assertEqual({name: numbers for name, numbers in found.items() if numbers}, {})

    def test_every_allowed_phrase_stands_in_its_text(self):
        self.assertEqual([(name, phrase) for name in self.allowed for phrase in self.phrases(name)
                          if not any(flat(phrase) in flat(text) for text in self.texts.get(name, []))], [])

    def test_every_allowed_phrase_has_a_kind_and_references_have_keys(self):
        keys = set(re.findall(r"^\| (\[\w+\])", (ROOT / "docs" / "references.md").read_text(), re.MULTILINE))
        for name, kinds in self.allowed.items():
            for what in kinds:
                kind, _, source = what.partition(": ")
                self.assertIn(kind, KINDS, name)
                self.assertTrue(source, name)
                self.assertLessEqual(set(re.findall(r"\[\w+\]", source)), keys, name)
                self.assertTrue(kind != "reference" or re.search(r"\[\w+\]", source), name)

    def test_results_typed_by_hand_are_found(self):
        for text in ("case 2 is 7.6 % below its test", "the plate deflects 2.91 in place of less",
                     "it was 18 per cent before", "the points take five times as long", "a peak of 35 MPa there",
                     "errors fall 2.1-fold", "at 3 to 5 m/s", "it keeps three quarters of its energy",
                     "the wave comes 1.4 us late"):
            self.assertTrue(typed([text], []), text)
        for text in ("case {} is {} % below its test", "<code>limit = 7.5 %</code> and `5 %`",
                     "[Cui14] Fig. 17, Eq. (67)"):
            self.assertEqual(typed([text], []), [], text)

    def test_values_and_docstrings_are_told_from_text(self):
        path = ROOT / "validation" / "confined.py"
        self.assertFalse(any("Over all that is not the plate" in text for text in strings_of(path)))
        self.assertFalse(any("[[obstacle]]" in text for text in strings_of(path)))


if __name__ == "__main__":
    unittest.main()
