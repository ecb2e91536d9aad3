# SPDX-License-Identifier: Apache-2.0
"""Whether the manifests of deploy/kubernetes belong together: what they name is there, and of the right kind.

usage: kubernetes_test.py TESSERA SOURCE_FOLDER; exits with 77 if it was skipped. This is no cluster and no schema.
"""
import pathlib
import sys

from program_options import Findings, check_command, yaml_module

yaml = yaml_module()
tessera, source = sys.argv[1], pathlib.Path(sys.argv[2])
folder = source / "deploy" / "kubernetes"
findings = Findings()
check = findings.check

kustomization = yaml.safe_load((folder / "kustomization.yaml").read_text())
files = sorted(f.name for f in folder.glob("*.yaml") if f.name != "kustomization.yaml")
check(files == sorted(kustomization["resources"]), f"kustomization.yaml lists other files than there are: {files}")
things = [thing for name in files for thing in yaml.safe_load_all((folder / name).read_text())]


def of_kind(kind):
    return [thing for thing in things if thing["kind"] == kind]


workloads = of_kind("StatefulSet") + of_kind("Deployment")
services = of_kind("Service")


def pods_with(labels):
    return [w for w in workloads if labels.items() <= w["spec"]["template"]["metadata"]["labels"].items()]


def port_names(workload):
    containers = workload["spec"]["template"]["spec"]["containers"]
    return {port["name"]: port["containerPort"] for c in containers for port in c.get("ports", [])}


def option(container, name):
    found = [a.split("=", 1)[1] for a in container["args"] if a.startswith(f"--{name}=")]
    return found[0] if found else None


def mebibytes(text):
    factors = {"Mi": 1, "Gi": 1024}
    return int(text[:-2]) * factors[text[-2:]]


def check_container(container, pod, name, volumes):
    where = f"{name}, container {container['name']}"
    for mount in container["volumeMounts"]:
        check(mount["name"] in volumes, f"{where}: mounts {mount['name']}, which is no volume")
    security = container["securityContext"]
    check(security["allowPrivilegeEscalation"] is False and security["readOnlyRootFilesystem"] is True
          and security["capabilities"] == {"drop": ["ALL"]}, f"{where}: is not closed")
    check("memory" in container["resources"]["limits"], f"{where}: has no limit of memory")
    names = {port["name"] for port in container.get("ports", [])}
    for probe in ("startupProbe", "readinessProbe", "livenessProbe"):
        if probe in container:
            words = container[probe].get("exec", {}).get("command", [""])
            asks_health = "/dev/tcp/127.0.0.1/7712;" in words[-1] and "GET /healthz " in words[-1]
            check(asks_health or container[probe].get("tcpSocket", {}).get("port") in names,
                  f"{where}: {probe} asks what is not there")
    if "args" not in container:
        return
    check_command(findings, tessera, container["args"], where)
    mounted = [m["mountPath"] for m in container["volumeMounts"]]
    for file_option in ("key", "allow", "server-key", "store", "cache"):
        path = option(container, file_option)
        if path is not None:
            check(any(path.startswith(m + "/") for m in mounted), f"{where}: nothing is mounted for {path}")
    memory = option(container, "memory")
    if memory is not None:
        check(int(memory) < mebibytes(container["resources"]["limits"]["memory"]), f"{where}: --memory is its limit")
    grace = option(container, "grace")
    if grace is not None:
        check(int(grace) < pod["terminationGracePeriodSeconds"], f"{where}: is killed before its --grace")


for workload in workloads:
    name = f"{workload['kind']} {workload['metadata']['name']}"
    spec = workload["spec"]
    pod = spec["template"]["spec"]
    check(workload in pods_with(spec["selector"]["matchLabels"]), f"{name}: selects other pods than its own")
    check(pod["securityContext"]["runAsNonRoot"] is True, f"{name}: may run as root")
    volumes = {v["name"] for v in pod["volumes"]} | {
        v["metadata"]["name"] for v in spec.get("volumeClaimTemplates", [])}
    for container in pod.get("initContainers", []) + pod["containers"]:
        check_container(container, pod, name, volumes)

for service in services:
    selected = pods_with(service["spec"]["selector"])
    check(len(selected) == 1, f"Service {service['metadata']['name']}: selects {len(selected)} workloads")
    for port in service["spec"]["ports"]:
        for workload in selected:
            check(port_names(workload).get(port["targetPort"]) == port["port"],
                  f"Service {service['metadata']['name']}: port {port['name']} leads nowhere")

for workload in of_kind("StatefulSet"):
    check(workload["spec"]["serviceName"] in {s["metadata"]["name"] for s in services},
          f"{workload['metadata']['name']}: its service is not there")
    container = workload["spec"]["template"]["spec"]["containers"][0]
    check(option(container, "listen").endswith(f":{port_names(workload)['farm']}"), "--listen is not port farm")

for workload in of_kind("Deployment"):
    host, port = option(workload["spec"]["template"]["spec"]["containers"][0], "coordinator").split(":")
    check(any(s["metadata"]["name"] == host and int(port) in [p["port"] for p in s["spec"]["ports"]]
              for s in services), f"workers look for {host}:{port}, which is no service")

for policy in of_kind("NetworkPolicy"):
    name, spec = policy["metadata"]["name"], policy["spec"]
    check(len(pods_with(spec["podSelector"]["matchLabels"])) == 1, f"NetworkPolicy {name}: is for no pod")
    for rule, workload_rules in (("ingress", spec["ingress"]), ("egress", spec["egress"])):
        check(rule.capitalize() in spec["policyTypes"], f"NetworkPolicy {name}: does not close {rule}")
        for one in workload_rules:
            for port in one["ports"]:
                if isinstance(port["port"], str):
                    check(any(port["port"] in port_names(w) for w in workloads),
                          f"NetworkPolicy {name}: no container has a port {port['port']}")

check(len(workloads) == 2 and len(services) == 1, "there are a coordinator, workers and a service")
findings.end()
