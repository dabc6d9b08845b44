"""Every path and name that docs/theory.md and docs/architecture.md give in `backticks` exists: files, folders,
functions, tests, keys of decks and commands."""
import functools
import pathlib
import re
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
FOLDERS = ("src", "tests", "cases", "docs", "validation", "python", "scripts", "benchmarks")
TEXTS = {".cpp", ".hpp", ".py", ".txt", ".toml", ".md", ""}


@functools.lru_cache
def files():
    return [path for folder in FOLDERS for path in (ROOT / folder).rglob("*")]


@functools.lru_cache
def text_of(folder):
    sources = [path for path in files() if path.is_file() and path.suffix in (".cpp", ".hpp")
               and path.relative_to(ROOT).parts[0] == folder]
    return "\n".join(path.read_text() for path in sources)


@functools.lru_cache
def words_of(folder):
    return set(re.findall(r"[A-Za-z_][A-Za-z0-9_]*", text_of(folder)))


def is_path(name):
    """A path from the root or from src, or the name of a file anywhere."""
    name = name.rstrip("/")
    if (ROOT / name).exists() or (ROOT / "src" / name).exists():
        return True
    return any(path.as_posix().endswith("/" + name) for path in files())


def is_test(suite, name):
    tests = re.findall(r"TEST(?:_F|_P)?\(\s*(\w+),\s*(\w+)\)", text_of("tests"))
    found = [test for own, test in tests if own == suite]
    instances = re.findall(r"INSTANTIATE_TEST_SUITE_P\(\s*(\w*),\s*(\w+)", text_of("tests"))
    known = found or any(suite in pair for pair in instances)
    return bool(known) if name == "*" else name in found


def exists(token):
    """Does what a document names exist? Words of prose in backticks count as names."""
    if re.match(r"\[\w+\] Eq\.", token):  # an equation
        return True
    first, *others = token.split()
    if first == "brisance":
        return all(word in words_of("src") for word in others if re.fullmatch(r"[a-z]\w*", word))
    if "/" in first or re.search(r"\.(cpp|hpp|py|md|toml)$", first):
        return is_path(first)
    if match := re.fullmatch(r"([A-Z]\w+)\.(\w+|\*)", first):
        return is_test(*match.groups())
    if re.fullmatch(r"[A-Z]\w+", first) and is_test(first, "*"):
        return True
    known = words_of("src") | {path.stem for path in files()}
    return all(word in known for word in re.findall(r"[A-Za-z_]\w*", token.split("=")[0]))


class Documents(unittest.TestCase):
    def test_names_of_theory_and_architecture_exist(self):
        for name, least in (("theory.md", 100), ("architecture.md", 30)):
            # NAME stands for whatever somebody adds.
            text = re.sub(r"`[^`\n]*NAME[^`\n]*`", "", (ROOT / "docs" / name).read_text())
            tokens = sorted(set(re.findall(r"`([^`\n]+)`", text)))
            self.assertGreater(len(tokens), least)
            self.assertEqual([token for token in tokens if not exists(token)], [])

    def test_what_does_not_exist_is_found(self):
        for token in ("src/mpm/no_such_file.cpp", "no_such_file.hpp", "Mpm::no_such_function", "HeldPlate.NoSuchTest",
                      "NoSuchSuite.*", "no_such_name", "[no_such_table]", "brisance no_such_command"):
            self.assertFalse(exists(token), token)


if __name__ == "__main__":
    unittest.main()
