"""The passes of a set of vector instructions share no function with the rest of the program.

    set_symbols.py OBJECT ...

Of an inline function that several files have the linker keeps one copy. Were it that of the file that is compiled for
the newest processors, the program would end on older ones in places that have nothing to do with the sets. Every weak
symbol of the objects must therefore name a vector of its own set.
"""
import pathlib
import re
import subprocess
import sys

SETS = {"sse2": "xsimd::sse2", "avx2": "xsimd::fma3<xsimd::avx2>", "avx512": "xsimd::avx512f"}


def main():
    if len(sys.argv) < 2:
        sys.exit("set_symbols: no objects")
    shared = []
    for path in sys.argv[1:]:
        name = re.search(r"brisance_passes_(\w+)\.dir", path).group(1)
        text = subprocess.run(["nm", "-C", path], check=True, capture_output=True, text=True).stdout
        weak = [line.split(None, 2)[2] for line in text.splitlines() if re.match(r"^[0-9a-f]+ [WVu] ", line)]
        print(f"{pathlib.Path(path).name} of {name}: {len(weak)} weak symbols")
        if not weak:
            sys.exit("set_symbols: none at all? The objects are not what this test takes them for.")
        # A word of data by which the runtime finds its handler of exceptions.
        shared += [f"{name}: {symbol}" for symbol in weak
                   if f"batch<double, {SETS[name]}" not in symbol and symbol != "DW.ref.__gxx_personality_v0"]
        code = subprocess.run(["objdump", "-d", "--no-show-raw-insn", path], check=True, capture_output=True,
                              text=True).stdout
        for register, sets in (("%ymm", ("sse2",)), ("%zmm", ("sse2", "avx2"))):
            if name in sets and register in code:
                sys.exit(f"set_symbols: {name} uses {register}, which its processors have not got")
        if name == "avx512" and "%zmm" not in code:
            sys.exit("set_symbols: avx512 uses no register of 512 bits")
    if shared:
        sys.exit("set_symbols: these are shared with files for other processors:\n  " + "\n  ".join(shared))


main()
