"""No page of the validation holds a measured number that was typed by hand.

The texts are in the strings of validation/*.py and validation/paper/*.py and in the templates validation/*.md.in.
Measurements enter them as {values} and @values@. Every other number must be listed in typed_numbers.toml with its kind:
a setting, a target set beforehand, an identity or a reference with its key.
"""
import ast
import re
import sys
import unittest
from pathlib import Path
from unittest import mock

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "validation"))
try:
    import tomllib  # not before Python 3.11

    import common
    import numpy as np
    import rupture
    from paper import slab3d, sod
except ImportError as missing:
    raise unittest.SkipTest(f"the Python package {missing.name} is missing") from missing

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
                 "points.md.in": "Linear shape functions", "paper/sod.py": "The remaining difference between the gas",
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


class Words(unittest.TestCase):
    """Words that depend on values."""

    def test_spans_and_lists(self):
        self.assertEqual([common.span(v, "{:+.1f}") for v in ([2.0, -1.04], [1.0, 1.04])], ["-1.0 to +2.0", "+1.0"])
        self.assertEqual([common.listed(w) for w in ([], ["a"], ["a", "b"], ["a", "b", "c"])],
                         ["none", "a", "a and b", "a, b and c"])

    def test_rooms_that_meet_the_target(self):
        text = rupture.told([(1.3, 1.0, 8, -0.09), (5.0, 1.0, 8, 0.049), (1.3, 1.0, 16, 0.02)])
        self.assertEqual(text, "With 8 cells met: 5 bar (1 m); missed: 1.3 bar (1 m). "
                               "With 16 cells met: 1.3 bar (1 m); missed: none")

    def test_thresholds_are_impossible_where_the_largest_edge_bears_more_than_the_smallest_centre(self):
        class Floor(slab3d.Floor):
            def __init__(self, centre, radius=(0.0, 0.4)):
                self.radius = np.array(radius)
                self.peak = self.impulse = np.array([centre, 0.2 * centre])

        with mock.patch.object(slab3d, "kingery_bulmash", lambda variants, mass, key: mass):
            heads = [slab3d.on_thresholds(None, {m: Floor(centre) for m, centre in zip(slab3d.MASSES, centres)})
                     for centres in ((1.0, 2.0, 4.0, 8.0), (1.0, 1.1, 1.2, 1.3))]
        self.assertIn("No damage that grows with the load", heads[0])
        self.assertIn("breaks nothing at 2 kg", heads[0])
        self.assertNotIn("No damage that grows with the load", heads[1])
        self.assertNotIn("breaks nothing", heads[1])

    def test_orders_and_costs_of_the_tube(self):
        cells = (250, 500, 1000)
        first = [{norm: 1.0 / n for norm in sod.NORMS} for n in cells]
        half = [{norm: n ** -0.5 for norm in sod.NORMS} for n in cells]
        errors = {(m, start, sod.COURANT): first if m in ("fdm", "muscl") else half
                  for m in sod.METHODS for start in (sod.EQUAL_VOLUMES, sod.EQUAL_MASSES)}

        def discussion(ratio, seconds):
            ratios = {(start, norm): ratio for start in (sod.EQUAL_VOLUMES, sod.EQUAL_MASSES) for norm in sod.NORMS}
            steps = dict.fromkeys(seconds, 100)
            return flat(sod.discussion(errors, cells, 1000, ratios, seconds, steps))
        text = discussion(2.0, {"fdm": 1.0, "mpm": 4.0, "cpgimp": 6.0})
        self.assertIn("Their order is 1.00 in L1 and 1.00 in L2", text)
        self.assertIn("the lines that require 1.5 reach it", text)
        self.assertIn("The order FDM, MPM, GIMP is that of the paper: 1.0 : 4.0 : 6.0", text)
        self.assertNotIn("the error does not fall", text)
        text = discussion(1.1, {"fdm": 1.0, "mpm": 4.0, "cpgimp": 3.0})
        self.assertIn("the lines that require 1.5 miss it", text)
        self.assertIn("is not that of the paper", text)

    def test_stress_at_the_interface(self):
        first = {key: (1.0 + k, 1.5 + k) for k, key in enumerate(slab3d.INTERFACES)}
        text = flat(slab3d.on_the_interface(first))
        self.assertIn("bear 1.00 to 1.50 (gimp), 2.00 to 2.50 (linear) and 3.00 to 3.50 (bspline) of it, in the middle "
                      "of a cell 4.00 to 4.50 (gimp) and 5.00 to 5.50 (linear)", text)


if __name__ == "__main__":
    unittest.main()
