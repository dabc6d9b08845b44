"""A fixed hash of a small coupled run: the same bits today as yesterday.

    scripts/fingerprint            builds `portable`, runs tests/portable/deck.toml and compares
    scripts/fingerprint --renew    writes the hash of the present program; say in the commit why it changed

The hash is that of the state in the checkpoint at the end, to the last bit and without the times of the clock. It holds
for the instruction set that every x86-64 machine has, for one compiler and for one mathematical library, which
tests/portable/fingerprint.json names; with others nothing is compared, and that is said.
"""
import argparse
import hashlib
import json
import os
import pathlib
import platform
import re
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
DECK = ROOT / "tests" / "portable" / "deck.toml"
RECORD = ROOT / "tests" / "portable" / "fingerprint.json"
# The library would choose functions by the processor, and their last digits with them.
BASELINE = {"GLIBC_TUNABLES": "glibc.cpu.hwcaps=-AVX2,-AVX512F,-FMA,-FMA4"}


def section(data, name):
    """Where a section of a checkpoint begins (src/core/archive.hpp)."""
    mark = b"SECT" + len(name).to_bytes(8, "little") + name.encode()
    at = data.find(mark)
    if at < 0:
        sys.exit(f"fingerprint: the checkpoint has no section \"{name}\"")
    return at


def state_of(checkpoint):
    """The state without what comes after a name: the seconds that a pass took."""
    data = checkpoint.read_bytes()
    state = bytearray(data[section(data, "world"):section(data, "output")])
    for found in re.finditer(rb"([\x03-\x28])\0{7}(?=[a-z])", bytes(state)):
        end = found.end() + found.group(1)[0]
        if re.fullmatch(rb"[a-z ]+", bytes(state[found.end():end])):
            state[end:end + 8] = bytes(8)
    return bytes(state)


def compiler():
    cache = (ROOT / "build" / "portable" / "CMakeCache.txt").read_text()
    path = re.search(r"^CMAKE_CXX_COMPILER:\w+=(.*)$", cache, re.MULTILINE).group(1)
    return subprocess.run([path, "--version"], check=True, capture_output=True, text=True).stdout.splitlines()[0]


def hash_of_run(threads):
    with tempfile.TemporaryDirectory() as folder:
        results = pathlib.Path(folder) / "results"
        command = [ROOT / "build" / "portable" / "bin" / "brisance", "run", DECK, "--output", results, "--quiet",
                   "--threads", str(threads), "--simd", "sse2"]
        subprocess.run(command, check=True, env=os.environ | BASELINE)
        newest = max((results / "checkpoints").glob("*.brz"))
        return hashlib.sha256(state_of(newest)).hexdigest()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--renew", action="store_true", help="write the hash instead of comparing it")
    renew = parser.parse_args().renew
    subprocess.run([ROOT / "scripts" / "build", "portable", "brisance"], check=True, stdout=subprocess.DEVNULL)
    hashes = {hash_of_run(threads) for threads in (1, 2)}
    if len(hashes) != 1:
        sys.exit("fingerprint: one and two threads do not give the same bits")
    now = {"compiler": compiler(), "libm": " ".join(platform.libc_ver()), "state": hashes.pop()}
    if renew:
        RECORD.write_text(json.dumps(now, indent=2) + "\n")
        print(f"fingerprint: {now['state']} written to {RECORD.relative_to(ROOT)}; the commit says why")
        return
    record = json.loads(RECORD.read_text())
    other = [key for key in ("compiler", "libm") if record[key] != now[key]]
    if other:
        print(f"fingerprint: not compared, the recorded one is that of {record['compiler']}, {record['libm']}")
    elif record["state"] != now["state"]:
        sys.exit(f"fingerprint: the state of {DECK.relative_to(ROOT)} is {now['state']}, recorded was "
                 f"{record['state']}. Numbers have changed: where they should, `scripts/fingerprint --renew`, and say "
                 "in the commit why")
    else:
        print("fingerprint: the same bits")


if __name__ == "__main__":
    main()
