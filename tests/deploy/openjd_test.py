# SPDX-License-Identifier: Apache-2.0
"""Whether deploy/openjd/template.yaml keeps the rules of jobtemplate-2023-09 that it makes use of, and whether the
commands that it stands for render frames. The published `openjd` program knows all of the rules; this does not.

usage: openjd_test.py TESSERA SOURCE_FOLDER; exits with 77 if it was skipped
"""
import os
import pathlib
import re
import subprocess
import sys
import tempfile

from program_options import Findings, check_command, yaml_module

yaml = yaml_module()
tessera, source = sys.argv[1], pathlib.Path(sys.argv[2])
template = yaml.safe_load((source / "deploy/openjd/template.yaml").read_text())
findings = Findings()
check = findings.check

# --- The rules ---
COMMON = {"name", "type", "description", "default", "allowedValues", "userInterface"}
FIELDS = {
    "STRING": COMMON | {"minLength", "maxLength"},
    "PATH": COMMON | {"minLength", "maxLength", "objectType", "dataFlow"},
    "INT": COMMON | {"minValue", "maxValue"},
    "FLOAT": COMMON | {"minValue", "maxValue"},
}
CONTROLS = {
    "STRING": {"LINE_EDIT", "MULTILINE_EDIT", "DROPDOWN_LIST", "CHECK_BOX", "HIDDEN"},
    "PATH": {"CHOOSE_INPUT_FILE", "CHOOSE_OUTPUT_FILE", "CHOOSE_DIRECTORY", "DROPDOWN_LIST", "HIDDEN"},
    "INT": {"SPIN_BOX", "DROPDOWN_LIST", "HIDDEN"},
    "FLOAT": {"SPIN_BOX", "DROPDOWN_LIST", "HIDDEN"},
}
IDENTIFIER = re.compile(r"[A-Za-z_][A-Za-z0-9_]{0,63}")
REFERENCE = re.compile(r"{{\s*([A-Za-z_][\w.]*)\s*}}")
RANGE = re.compile(r"-?\d+(--?\d+(:-?[1-9]\d*)?)?(\s*,\s*-?\d+(--?\d+(:-?[1-9]\d*)?)?)*")


def only(thing, fields, where):
    check(set(thing) <= set(fields), f"{where}: has {sorted(set(thing) - set(fields))}")


def check_parameter(p):
    where = f"parameter {p['name']}"
    check(IDENTIFIER.fullmatch(p["name"]), f"{where}: is no identifier")
    only(p, FIELDS[p["type"]], where)
    interface = p.get("userInterface", {})
    check(interface.get("control") in CONTROLS[p["type"]], f"{where}: has no such control")
    check((interface["control"] == "DROPDOWN_LIST") == ("allowedValues" in p), f"{where}: its control does not fit")
    check(1 <= len(interface["label"]) <= 64, f"{where}: its label is too long")
    for one in interface.get("fileFilters", []):
        only(one, {"label", "patterns"}, where)
        check(all(re.fullmatch(r"\*|\*\.\*|\*\.\w+", x) and len(x) <= 20 for x in one["patterns"]), f"{where}: {one}")
    check(len(p.get("description", "")) <= 2048, f"{where}: its description is too long")
    if "default" not in p:
        return
    default = p["default"]
    check(default in p.get("allowedValues", [default]), f"{where}: its default is not allowed")
    if p["type"] == "INT":
        check(p.get("minValue", default) <= default <= p.get("maxValue", default), f"{where}: its default is out of range")
    else:
        check(isinstance(default, str) and p.get("minLength", 0) <= len(default) <= p.get("maxLength", 1024),
              f"{where}: its default has no such length")


def check_references(text, known, where):
    for name in REFERENCE.findall(text):
        check(name in known, f"{where}: {name} is not defined")
    check(text.count("{{") == len(REFERENCE.findall(text)), f"{where}: has braces that refer to nothing")


def check_step(step, known):
    where = f"step {step['name']}"
    only(step, {"name", "description", "dependencies", "stepEnvironments", "hostRequirements", "parameterSpace",
                "script"}, where)
    check(1 <= len(step["name"]) <= 64, f"{where}: its name is too long")
    space = step["parameterSpace"]
    only(space, {"taskParameterDefinitions", "combination"}, where)
    tasks = set()
    for p in space["taskParameterDefinitions"]:
        only(p, {"name", "type", "range"}, where)
        check(p["type"] in {"INT", "FLOAT", "STRING", "PATH"}, f"{where}: {p['type']}")
        check_references(p["range"], known, where)
        tasks.add(f"Task.Param.{p['name']}")
    only(step.get("hostRequirements", {}), {"amounts", "attributes"}, where)
    for attribute in step.get("hostRequirements", {}).get("attributes", []):
        only(attribute, {"name", "anyOf", "allOf"}, where)
        check(attribute["name"].startswith("attr."), f"{where}: {attribute['name']}")
    only(step["script"], {"actions", "embeddedFiles"}, where)
    only(step["script"]["actions"], {"onRun"}, where)
    action = step["script"]["actions"]["onRun"]
    only(action, {"command", "args", "timeout", "cancelation"}, where)
    cancelation = action["cancelation"]
    only(cancelation, {"mode", "notifyPeriodInSeconds"}, where)
    check(cancelation["mode"] == "NOTIFY_THEN_TERMINATE" and 0 < cancelation["notifyPeriodInSeconds"] <= 600,
          f"{where}: is cancelled otherwise")
    for text in [action["command"], *action["args"]]:
        check(isinstance(text, str), f"{where}: argument {text} is no text")
        check_references(text, known | tasks, where)


only(template, {"specificationVersion", "$schema", "name", "description", "parameterDefinitions", "jobEnvironments",
                "steps"}, "template")
check(template["specificationVersion"] == "jobtemplate-2023-09", "template: is of another version")
parameters = template["parameterDefinitions"]
check(1 <= len(parameters) <= 50, "template: has too many parameters")
check(len({p["name"] for p in parameters}) == len(parameters), "template: a parameter is there twice")
for parameter in parameters:
    check_parameter(parameter)
known = {f"{kind}.{p['name']}" for kind in ("Param", "RawParam") for p in parameters}
check_references(template["name"], known, "template")
for one_step in template["steps"]:
    check_step(one_step, known)
run = template["steps"][0]["script"]["actions"]["onRun"]
check(RANGE.fullmatch(next(p["default"] for p in parameters if p["name"] == "Frames")), "Frames: is no range")
check(run["command"] == "tessera", "the command is another program")
check_command(findings, tessera, run["args"], "template")

# --- Two of its tasks, as a render manager would run them ---
with tempfile.TemporaryDirectory() as folder:
    values = {f"Param.{p['name']}": p.get("default") for p in parameters}
    values |= {"Param.SceneFile": str(source / "scenes/cornell.json"), "Param.OutputFolder": folder,
               "Param.Quality": "draft", "Param.Width": 32, "Param.Height": 32}
    for frame in (1, 2):
        values["Task.Param.Frame"] = frame
        words = [tessera] + [REFERENCE.sub(lambda m: str(values[m.group(1)]), a) for a in run["args"]]
        done = subprocess.run(words, capture_output=True, text=True, env=os.environ | {"OPENJD_SESSION": "1"})
        check(done.returncode == 0, f"frame {frame}: exit code {done.returncode}: {done.stderr}")
        check("openjd_progress:" in done.stdout, f"frame {frame}: says no progress: {done.stdout}")
        check((pathlib.Path(folder) / f"shot.{frame:04}.exr").is_file(), f"frame {frame}: there is no image")
findings.end()
