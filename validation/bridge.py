"""The bridge: a page with what the tests of tests/bridge measure."""
import re
import subprocess
import sys
from pathlib import Path

from common import ROOT, commit, machine

PARTS = {
    "test_bridge_uniform": ("Uniform gas", "Targets: 1e-12 at rest, 1e-3 in motion."),
    "test_bridge_tubes": ("Shock tubes", "Targets: mass to 1e-13, energy to 0.1 %, errors of the gas at most 1.5 times "
                          "those of the gas scheme alone, no peak above 2 % at the bridge. The transport as printed in "
                          "the paper is shown for comparison."),
    "test_bridge_pulses": ("Sound", "Targets at 20 cells: less than 1 % reflected, more than 98 % transmitted."),
    "test_bridge_contacts": ("Contacts between products and air", "Target: pressure within 3 %."),
    "test_bridge_wall": ("A wall of steel, a clamped plate", "Targets: pressure within 2 %, momentum within 1 %; "
                         "beside the plate, impulse and speed of the gas as before a wall within 12 %."),
    "test_bridge_running": ("Activation, steps, regions", ""),
}
TALK = re.compile(r"^(\[|Running main|Note: Google Test|  YOU HAVE|.*Failure$|Expected|The difference|"
                  r".* evaluates to|$)")


def validate(arguments):
    """Writes docs/validation/bridge.md."""
    programs = Path(arguments.brisance).parent
    text = ["# The bridge between gas and material points", "",
            "Produced by `validation/run bridge`: the lines that the programs of `tests/bridge` print about their",
            "measurements. Their assertions are in their sources; a program that fails is named. Settings of the",
            "region are the defaults unless a line says otherwise.", ""]
    for name, (title, asked) in PARTS.items():
        if not (programs / name).exists():
            sys.exit(f"{programs / name} does not exist; build the tests")
        print(f"{name} ...", flush=True)
        done = subprocess.run([str(programs / name), "--gtest_also_run_disabled_tests"],
                              capture_output=True, text=True)
        lines = [line for line in done.stdout.split("\n") if not TALK.match(line)]
        command = f"`build/release/bin/{name} --gtest_also_run_disabled_tests`"
        outcome = "" if done.returncode == 0 else " (**fails**)"
        text += [f"## {title}", "", *([asked, ""] if asked else []), command + outcome, "", "```", *lines, "```", ""]
    text.append(f"Command: `validation/run bridge`; commit {arguments.commit or commit()}; {machine()}.")
    page = ROOT / "docs" / "validation" / "bridge.md"
    page.write_text("\n".join(text) + "\n")
    print(f"wrote {page}")
