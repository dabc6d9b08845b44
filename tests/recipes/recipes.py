"""The toy models that follow the recipes of CONTRIBUTING.md: what scripts/recipes and the tests know of them.

NAME.diff holds a toy as a diff against the present tree (git diff -U1). Its head says what is checked:
    Recipe: the section of CONTRIBUTING.md, whose paths in backticks are all that the diff may touch
    Tests: PROGRAM FILTER, a test program and which of its tests (any number of lines)
    Deck: a deck of the tree with the toy, which must run
    Info: a text that the manual of the built program must hold (optional)
    Holds: FILE TEXT, a file of the deck's results and a text that it must hold (optional)
"""
import argparse
import fnmatch
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
FOLDER = pathlib.Path(__file__).resolve().parent
KEYS = ("Recipe", "Tests", "Deck", "Info", "Holds")
ONCE = ("Recipe", "Deck")


class Failure(Exception):
    """What is wrong with a toy, in one line."""


def names():
    return sorted(path.stem for path in FOLDER.glob("*.diff"))


def head_of(text):
    """The keys before the diff itself, each with the list of its values."""
    head = {key: [] for key in KEYS}
    for line in text.split("\ndiff --git ")[0].splitlines():
        key, colon, value = line.partition(": ")
        if colon and key in head:
            head[key].append(value.strip())
    for key in ONCE:
        if len(head[key]) != 1:
            raise Failure(f"the head has {len(head[key])} lines \"{key}: ...\" instead of one")
    if not head["Tests"]:
        raise Failure("the head names no test (\"Tests: PROGRAM FILTER\")")
    return head


def touched(text):
    """The files that a diff changes or makes."""
    return sorted(set(re.findall(r"^\+\+\+ b/(\S+)", text, re.M) + re.findall(r"^--- a/(\S+)", text, re.M)))


def named_by(recipe, contributing):
    """The paths that a section names in backticks, as patterns; NAME stands for any word, in the name of a new file."""
    sections = dict(re.findall(r"^## ([^\n]+)\n(.*?)(?=^## |\Z)", contributing, re.M | re.S))
    if recipe not in sections:
        raise Failure(f"CONTRIBUTING.md has no recipe \"{recipe}\"")
    marked = re.findall(r"`([^`\s]+)`", sections[recipe])
    return [path.replace("NAME", "*") for path in marked if "/" in path and re.search(r"\.\w+$", path)]


def is_named(path, patterns):
    if path in patterns:
        return True
    new = [pattern for pattern in patterns if "*" in pattern and path.count("/") == pattern.count("/")]
    return not (ROOT / path).exists() and any(fnmatch.fnmatchcase(path, pattern) for pattern in new)


def apply(diff, tree, dry=False):
    """Applies a diff to a tree, wherever that lies: git must not look for a repository around it."""
    command = ["git", "apply", *(["--check"] if dry else []), str(diff)]
    done = subprocess.run(command, cwd=tree, capture_output=True, text=True,
                          env={**os.environ, "GIT_CEILING_DIRECTORIES": str(tree.parent)})
    if done.returncode:
        lines = (done.stdout + done.stderr).strip().splitlines()
        raise Failure(f"does not apply: {lines[0] if lines else 'git apply failed'}")


def check(name):
    """That the diff applies to the present tree and keeps to its recipe; returns its head."""
    diff = FOLDER / f"{name}.diff"
    text = diff.read_text()
    head = head_of(text)
    files = touched(text)
    patterns = named_by(head["Recipe"][0], (ROOT / "CONTRIBUTING.md").read_text())
    for path in files:
        if not is_named(path, patterns):
            raise Failure(f"touches {path}, which the recipe \"{head['Recipe'][0]}\" does not name")
    if head["Deck"][0] not in files:
        raise Failure(f"has no deck {head['Deck'][0]}")
    with tempfile.TemporaryDirectory(prefix="recipes-") as folder:
        tree = pathlib.Path(folder).resolve() / "tree"
        tree.mkdir()
        for path in files:
            if (ROOT / path).exists():
                (tree / path).parent.mkdir(parents=True, exist_ok=True)
                shutil.copy(ROOT / path, tree / path)
        apply(diff, tree)
    return head


def copy_of_the_tree(tree):
    listed = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, check=True, capture_output=True).stdout
    for path in listed.decode().split("\0"):
        if path and (ROOT / path).is_file():
            (tree / path).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(ROOT / path, tree / path)


def run(command, log, cwd, **more):
    """Runs a command; its output goes to the log. Raises Failure with the line that says what is wrong."""
    done = subprocess.run(command, cwd=cwd, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, **more)
    with log.open("a") as out:
        out.write(f"$ {' '.join(map(str, command))}\n{done.stdout}\n")
    if done.returncode:
        lines = done.stdout.strip().splitlines() or ["no output"]
        telling = [line for sign in (": error: ", "[  FAILED  ]", "FAILED", "error") for line in lines if sign in line]
        raise Failure(f"{pathlib.Path(command[0]).name}: {(telling or lines)[0].strip()[:200]}")
    return done.stdout


def build(tree, targets, log, jobs):
    options = ["-G", "Ninja", "-B", "build", "-DCMAKE_BUILD_TYPE=", "-DCMAKE_CXX_FLAGS=-O0",
               "-DBRISANCE_BENCHMARKS=OFF", "-DBRISANCE_NATIVE=OFF"]
    environment = dict(os.environ)
    if shutil.which("ccache"):
        options.append("-DCMAKE_CXX_COMPILER_LAUNCHER=ccache")
        # Paths of the temporary folder must not tell one build from the next.
        environment.update(CCACHE_BASEDIR=str(tree), CCACHE_NOHASHDIR="1")
    run(["cmake", *options, "."], log, tree, env=environment)
    run(["cmake", "--build", "build", "-j", str(jobs), "--target", "brisance", *targets], log, tree, env=environment)


def manual_of(tree, log):
    """Prints the manual again, as the recipes say."""
    manual = run([tree / "build/bin/brisance", "info", "--deck-reference"], log, tree)
    (tree / "docs/deck.md").write_text(manual)
    return manual


def prove(name, head, tree, manual, log, passed):
    """The tests, the manual and the deck of a toy in a built tree; `passed`: tests that need not run again."""
    for text in head["Info"]:
        if text not in manual:
            raise Failure(f"the manual does not hold \"{text}\"")
    for test in head["Tests"]:
        program, _, pattern = test.partition(" ")
        if test in passed:
            continue
        output = run([tree / "build/bin" / program, f"--gtest_filter={pattern}"], log, tree)
        if not re.search(r"\[  PASSED  \] [1-9]", output):
            raise Failure(f"{program} has no test {pattern}")
        passed.add(test)
    out = tree / "out" / name
    run([tree / "build/bin/brisance", "run", "--quiet", "--force", "--output", out, head["Deck"][0]], log, tree)
    for holds in head["Holds"]:
        file, _, text = holds.partition(" ")
        if text not in (out / file).read_text():
            raise Failure(f"{file} of the results does not hold \"{text}\"")


def failed_at(work, recipes, say):
    """Does some work for several toys; a Failure is said of all of them. Returns whether it failed."""
    try:
        work()
        return False
    except Failure as failure:
        for name in recipes:
            say(name, str(failure))
        return True


def build_and_prove(recipes, folder, say, jobs):
    """Toys in one copy of the tree: {name: head}."""
    tree = folder / "tree"
    tree.mkdir(parents=True)
    log = folder / "log"
    copy_of_the_tree(tree)
    for name in recipes:
        if failed_at(lambda: apply(FOLDER / f"{name}.diff", tree), [name], say):
            return
    targets = sorted({test.split()[0] for head in recipes.values() for test in head["Tests"]})
    manual = []
    passed = set()

    def make():
        build(tree, targets, log, jobs)
        manual.append(manual_of(tree, log))
    if failed_at(make, recipes, say):
        return
    for name, head in recipes.items():
        if not failed_at(lambda: prove(name, head, tree, manual[0], log, passed), [name], say):
            say(name, "")


def main():
    parser = argparse.ArgumentParser(prog="scripts/recipes", description="Builds and tests the toys of the recipes.")
    parser.add_argument("names", nargs="*", metavar="NAME", help="a toy, tests/recipes/NAME.diff; without it all")
    parser.add_argument("--check", action="store_true", help="only whether the diffs apply and keep to their recipes")
    parser.add_argument("--together", action="store_true", help="all toys in one copy of the tree, with one build")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="compilers at a time")
    parser.add_argument("--keep", metavar="DIR", type=pathlib.Path, help="an empty folder for the copies, which stay")
    arguments = parser.parse_args()
    chosen = arguments.names or names()
    for name in chosen:
        if name not in names():
            parser.error(f"there is no tests/recipes/{name}.diff; there are {', '.join(names())}")
    failed = []

    def say(name, failure):
        print(f"{name:16} {'FAILED: ' + failure if failure else 'passed'}", flush=True)
        if failure:
            failed.append(name)

    heads = {}
    for name in chosen:
        def examine():
            heads[name] = check(name)
        if not failed_at(examine, [name], say) and arguments.check:
            say(name, "")
    if not arguments.check:
        with tempfile.TemporaryDirectory(prefix="recipes-") as temporary:
            folder = (arguments.keep or pathlib.Path(temporary)).resolve()
            groups = [heads] if arguments.together else [{name: head} for name, head in heads.items()]
            for group in groups:
                if group:
                    build_and_prove(group, folder / "+".join(group)[:60], say, arguments.jobs)
            if failed and not arguments.keep:
                print("--keep DIR keeps the copies, with what was built and a log")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
