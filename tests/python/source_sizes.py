"""Sizes of the source: source_sizes.py [--all] prints what in src/ is larger than it may be, and fails if anything is.

A file has at most 450 lines, a function 70 (from the first line of its declaration to its closing brace, lambdas within
it included), a class 20 public member functions (overloads one by one; constructors, destructors, assignments and what
is deleted do not count). `EXCEPTIONS` names what may be larger, with the reason; one that is no longer needed is an
error, too. With --all prints the largest of each kind instead.

The reader knows the shape that clang-format gives the source, not the whole language: it follows braces, and takes what
opens one outside functions for a function where a parenthesis stands before it.
"""
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
LIMITS = {"file": 450, "function": 70, "class": 20}

# What may be larger: (kind, file, name) -> reason.
KERNEL = "a kernel: one vector loop over points, whose lines name the components of tensors"
CELLS = "a kernel: a row of small vector loops over cells, which pass on their arrays"
EXCEPTIONS = {
    ("function", "src/material/stress_stages.hpp", "trial_deviator"): KERNEL,
    ("function", "src/gas/schemes/lax_wendroff.hpp", "lax_wendroff_faces"): CELLS,
}

TOKEN = re.compile(
    r'//[^\n]*|/\*.*?\*/'  # comments
    r'|R"(?P<mark>[^(\s]*)\(.*?\)(?P=mark)"|"(?:\\.|[^"\\\n])*"'  # strings
    r"|(?<![0-9a-zA-Z])'(?:\\.|[^'\\\n])*'",  # characters, not the marks between digits
    re.S)


def bare(text):
    """The text without comments, contents of strings and preprocessor lines; line breaks stay."""
    def blank(match):
        found = match.group(0)
        return re.sub(r"[^\n]", " ", found) if found.startswith("/") else '"' + "\n" * found.count("\n") + '"'
    text = TOKEN.sub(blank, text)
    return re.sub(r"(?m)^[ \t]*#(?:.*\\\n)*.*$", lambda match: "\n" * match.group(0).count("\n"), text)


def without_templates(head):
    """A declaration without what stands in angle brackets."""
    head = re.sub(r"operator\s*(<=>|<<|>>|<=|>=|<|>|->)", "operator_", head)
    previous = None
    while previous != head:
        previous = head
        head = re.sub(r"<[^<>;{}]*>", " ", head)
    return head


def kind_of(head):
    """What a brace opens that follows the head outside functions."""
    plain = without_templates(head)
    if re.search(r"\bnamespace\b", plain) or re.search(r'extern ""', plain):
        return "namespace"
    if re.match(r"\s*(?:template\b)?\s*(?:class|struct|union)\b(?!.*\()", plain, re.S):
        return "class"
    if re.match(r"\s*enum\b", plain) or "(" not in plain:
        return "value"
    before = re.split(r"\(", plain, maxsplit=1)[0]
    if re.search(r"(?<![=!<>])=(?!=)", before) and "operator" not in before:
        return "value"
    # A member that a constructor initialises with braces.
    if re.search(r"\)\s*(?:noexcept\s*)?:(?!:)", plain) and re.search(r"[\w>]\s*$", plain):
        return "value"
    return "function"


def name_of(head):
    """The name that a head declares."""
    plain = without_templates(head)
    match = re.search(r"(operator\s*(?:\(\)|\[\]|[^\s(]+)|~?[\w:]+)\s*\(", plain)
    return re.sub(r"\s", "", match.group(1)) if match else plain.strip()


def class_name(head):
    plain = without_templates(head)
    match = re.search(r"\b(?:class|struct|union)\s+(?:alignas\s*\([^)]*\)\s*)?([\w:]+)", plain)
    return match.group(1) if match else "(unnamed)"


def counts_as_method(head, of):
    """Is it the declaration of a member function, other than those that every class has?"""
    plain = without_templates(head).strip()
    if "(" not in plain or re.match(r"(friend|using|typedef|static_assert|static constexpr \w+ \w+ =)\b", plain):
        return False
    before = plain.split("(")[0]
    if re.search(r"(?<![=!<>])=(?!=)", before) and "operator" not in before:
        return False
    if re.search(r"=\s*(delete|default)\s*$", plain):
        return False
    name = name_of(head)
    return name not in (of, "~" + of, "operator=")


def read(path):
    """Functions [(name, lines)] and classes [(name, public member functions)] of a file."""
    text = bare(path.read_text())
    functions, classes = [], []
    stack = []  # of [kind, name, access, methods]
    head, begin, line, depth = "", None, 1, 0
    inner = 0  # braces within a function or a value
    within = None

    def member(declaration):
        kind, of, access, methods = stack[-1] if stack else ("", "", "", None)
        if kind == "class" and access == "public" and counts_as_method(declaration, of):
            methods.append(name_of(declaration))

    for c in text:
        if c == "\n":
            line += 1
        if inner:
            inner += (c == "{") - (c == "}")
            if inner == 0:
                if within == "function":
                    functions.append((name_of(head), line - begin + 1))
                    member(head)
                    head, begin = "", None
                else:
                    head += "_"
            continue
        depth += (c in "([") - (c in ")]")
        if c == "{":
            kind = kind_of(head) if depth == 0 else "value"
            if kind in ("namespace", "class"):
                access = "private" if re.search(r"\bclass\b", without_templates(head)) else "public"
                stack.append([kind, class_name(head) if kind == "class" else "", access, []])
                head, begin = "", None
            else:
                inner, within = 1, kind
            continue
        if c == "}":
            kind, name, _, methods = stack.pop()
            if kind == "class":
                classes.append((name, len(methods)))
                head, begin = "_", line  # what follows may declare a variable of it
            else:
                head, begin = "", None
            continue
        if c == ";" and depth == 0:
            member(head)
            head, begin = "", None
            continue
        if c == ":" and stack and stack[-1][0] == "class" and head.strip() in ("public", "private", "protected"):
            stack[-1][2] = head.strip()
            head, begin = "", None
            continue
        if begin is None and not c.isspace():
            begin = line
        head += c
    if stack or inner:
        raise SystemExit(f"source_sizes: {path}: braces do not close; the reader does not understand the file")
    return functions, classes


def main():
    sizes = []  # (kind, file, name, size)
    for path in sorted((ROOT / "src").rglob("*.[ch]pp")):
        file = str(path.relative_to(ROOT))
        sizes.append(("file", file, "", len(path.read_text().splitlines())))
        functions, classes = read(path)
        sizes += [("function", file, name, size) for name, size in functions]
        sizes += [("class", file, name, size) for name, size in classes]
    if "--all" in sys.argv[1:]:
        for kind, limit in LIMITS.items():
            largest = sorted((s for s in sizes if s[0] == kind), key=lambda s: -s[3])[:30]
            for _, file, name, size in largest:
                print(f"{kind:8} {size:4}  {file} {name}")
        return 0
    unit = {"file": "lines", "function": "lines", "class": "public member functions"}
    large = [s for s in sizes if s[3] > LIMITS[s[0]]]
    failed = False
    for kind, file, name, size in large:
        if (kind, file, name) not in EXCEPTIONS:
            print(f"{file}: {kind} {name + ' ' if name else ''}has {size} {unit[kind]}, at most {LIMITS[kind]}")
            failed = True
    for kind, file, name in EXCEPTIONS:
        if (kind, file, name) not in {s[:3] for s in large}:
            print(f"source_sizes: the exception of {kind} {name} in {file} is no longer needed: take it out")
            failed = True
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
