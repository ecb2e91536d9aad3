# SPDX-License-Identifier: Apache-2.0
"""Whether what deploy/docker names is there: files that are copied, Debian packages, services, volumes, options.

usage: docker_test.py TESSERA SOURCE_FOLDER; exits with 77 if it was skipped. It builds no image.
"""
import pathlib
import re
import shutil
import subprocess
import sys

from program_options import Findings, check_command, skip, yaml_module

yaml = yaml_module()
tessera, source = sys.argv[1], pathlib.Path(sys.argv[2])
findings = Findings()
check = findings.check
if shutil.which("apt-cache") is None:
    skip("there is no apt-cache to ask for packages")

# --- The Dockerfile ---
text = (source / "deploy/docker/Dockerfile").read_text()
lines = [" ".join(line.split()) for line in re.sub(r"\\\n", " ", re.sub(r"(?m)^#.*\n", "", text)).splitlines() if line]
stages = set()
for line in lines:
    word, rest = line.split(" ", 1)
    check(word in {"FROM", "WORKDIR", "COPY", "RUN", "ARG", "ENV", "USER", "VOLUME", "EXPOSE", "STOPSIGNAL", "ENTRYPOINT",
                   "CMD"}, f"Dockerfile: {word} is no instruction that is used here")
    if word == "FROM":
        check(rest.split()[0] in {"debian:12", "debian:12-slim"}, f"Dockerfile: begins with {rest}")
        if " AS " in rest:
            stages.add(rest.split(" AS ")[1])
    if word == "COPY":
        words = rest.split()
        if words[0].startswith("--from="):
            check(words[0].removeprefix("--from=") in stages, f"Dockerfile: copies from {words[0]}")
        else:
            for name in words[:-1]:
                check((source / name).exists(), f"Dockerfile: copies {name}, which is not there")
users = [line.split(" ", 1)[1] for line in lines if line.startswith("USER ")]
check(users and users[-1] not in {"root", "0", "0:0"}, "Dockerfile: the image runs as root")

needed = subprocess.run(["bash", source / "run", "packages"], check=True, capture_output=True, text=True).stdout.split()
check(len(needed) > 20 and "cmake" in needed, "./run packages prints no packages")
named = re.findall(r"--no-install-recommends ([a-z0-9.+ -]+?)(?: &&|$)", " ; ".join(lines))
packages = needed + [package for names in named for package in names.split()]
check("pocl-opencl-icd" in packages[len(needed):], "Dockerfile: the image has no OpenCL")
shown = subprocess.run(["apt-cache", "show", "--no-all-versions", *packages], capture_output=True, text=True).stdout
there = set(re.findall(r"(?m)^Package: (.*)$", shown))
if not there:
    skip("apt-cache knows no package yet (apt-get update)")
for package in packages:
    check(package in there, f"there is no package {package}")

# --- compose.yaml ---
folder = source / "deploy/docker"
compose = yaml.safe_load((folder / "compose.yaml").read_text())
ports = set()
for name, service in compose["services"].items():
    build = service["build"]
    check((folder / build["context"] / build["dockerfile"]).is_file(), f"{name}: is built from what is not there")
    for other in service.get("depends_on", []):
        check(other in compose["services"], f"{name}: depends on {other}")
    for volume in service.get("volumes", []):
        check(volume[0] in "/.$" or volume.split(":")[0] in compose["volumes"], f"{name}: there is no volume {volume}")
    if "entrypoint" not in service and "command" in service:
        check_command(findings, tessera, service["command"], name)
        words = service["command"]
        ports |= {words[i + 1].split(":")[1] for i, w in enumerate(words) if w in ("--coordinator", "--listen")}
        if "--grace" in words:
            stop = int(service["stop_grace_period"].removesuffix("s"))
            check(int(words[words.index("--grace") + 1]) < stop, f"{name}: is killed before its --grace")
check(ports == {"7711"}, f"workers and coordinator have other ports: {ports}")
findings.end()
