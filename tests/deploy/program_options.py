# SPDX-License-Identifier: Apache-2.0
"""What the checks of deploy/ share: skipping, failing, and which options a program has."""
import re
import subprocess
import sys


def skip(reason):
    print(f"skipped: {reason}")
    sys.exit(77)


def yaml_module():
    try:
        import yaml
    except ImportError:
        skip("python3 has no yaml (apt-get install python3-yaml)")
    return yaml


class Findings:
    """Collects what is wrong, so that one run tells all of it."""

    def __init__(self):
        self.count = 0

    def check(self, right, what):
        if not right:
            self.count += 1
            print(f"wrong: {what}")
        return right

    def end(self):
        print("ok" if self.count == 0 else f"{self.count} wrong")
        sys.exit(0 if self.count == 0 else 1)


def options_of(tessera, subcommand):
    """The long options of a subcommand, as its help lists them."""
    text = subprocess.run([tessera, subcommand, "--help"], check=True, capture_output=True, text=True).stdout
    return set(re.findall(r"(?<![\w-])--[a-z][a-z-]*", text))


def check_command(findings, tessera, words, where):
    """words: a subcommand and what follows; each option of it must be one that the program has."""
    accepted = options_of(tessera, words[0])
    for word in words[1:]:
        name = word.split("=")[0]
        if name.startswith("--"):
            findings.check(name in accepted, f"{where}: tessera {words[0]} has no {name}")
