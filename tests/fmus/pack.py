#!/usr/bin/env python3
"""Packs a library of this folder as an FMU: pack.py 2|3 LIBRARY OUT.fmu [ATTRIBUTE=VALUE of CoSimulation...]. OUT.toml
is then an experiment that has the FMU in base64. The value references are those of law_model.h."""
import base64
import math
import pathlib
import sys
import zipfile


def variables(version):
    """Each variable: name, reference, causality, variability, type, start, extents if it is an array."""
    rows = []
    def vector(name, reference, causality):
        start = None if causality == "output" else "0"
        if version == 3:
            rows.append((name, reference, causality, "continuous", "Float64", start, (3,)))
            return
        for k in range(3):
            rows.append((f"{name}[{k + 1}]", reference + k, causality, "continuous", "Float64", start, None))
    vector("p", 1, "input")
    vector("v", 4, "input")
    for place in range(2):
        vector(f"neighbour[{place + 1}].p", 10 + 5 * place, "input")
        rows.append((f"neighbour[{place + 1}].weight", 13 + 5 * place, "input", "continuous", "Float64", "0", None))
        rows.append((f"neighbour[{place + 1}].heard", 14 + 5 * place, "input", "continuous", "Float64", "0", None))
    if version == 3:
        rows.append(("neighbour_p", 70, "input", "continuous", "Float64", "0", (2, 3)))
    else:
        for k in range(6):
            name = f"neighbour_p[{k // 3 + 1},{k % 3 + 1}]"
            rows.append((name, 70 + k, "input", "continuous", "Float64", "0", None))
    rows.append(("p_gain", 30, "parameter", "tunable", "Float64", "1", None))
    rows.append(("beta", 31, "parameter", "fixed", "Float64", "1", None))
    rows.append(("does", 40, "parameter", "fixed", "Int32", "0", None))
    rows.append(("id", 41, "input", "discrete", "Int32", "0", None))
    rows.append(("label", 50, "parameter", "fixed", "String", "none", None))
    vector("u", 60, "output")
    rows.append(("message[1]", 63, "output", "continuous", "Float64", None, None))
    return rows


def element(version, row):
    name, reference, causality, variability, kind, start, size = row
    common = f'name="{name}" valueReference="{reference}" causality="{causality}" variability="{variability}"'
    if version == 2:
        kind = {"Float64": "Real", "Int32": "Integer"}.get(kind, kind)
        return f"<ScalarVariable {common}><{kind}" + (f' start="{start}"' if start else "") + "/></ScalarVariable>"
    if kind == "String":
        return f'<String {common}><Start value="{start}"/></String>'
    start = f' start="{" ".join([start] * math.prod(size or (1,)))}"' if start else ""
    dimension = "".join(f'<Dimension start="{extent}"/>' for extent in size or ())
    return f"<{kind} {common}{start}>{dimension}</{kind}>"


def description(version, attributes=()):
    token = "guid" if version == 2 else "instantiationToken"
    more = "".join(f' {name}="{value}"' for name, value in (attribute.split("=") for attribute in attributes))
    rows = "\n".join("    " + element(version, row) for row in variables(version))
    return f"""<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="{version}.0" modelName="law" {token}="{{law}}">
  <CoSimulation modelIdentifier="law" canHandleVariableCommunicationStepSize="true"{more}/>
  <LogCategories><Category name="logEvents"/><Category name="logStatusWarning"/></LogCategories>
  <ModelVariables>
{rows}
  </ModelVariables>
  <ModelStructure/>
</fmiModelDescription>
"""


def experiment(fmu):
    return f"""[run]
duration_s = 1
[agents]
count = 3
[law]
name = "fmu"
fmu_base64 = "{base64.b64encode(fmu.read_bytes()).decode()}"
fmu_file = "the consensus law"
"""


def main():
    version, library, out = int(sys.argv[1]), sys.argv[2], pathlib.Path(sys.argv[3])
    with zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("modelDescription.xml", description(version, sys.argv[4:]))
        folder = "linux64" if version == 2 else "x86_64-linux"
        archive.write(library, f"binaries/{folder}/law.so")
        archive.writestr("documentation/index.html", "<p>The consensus law.</p>")
        archive.writestr("resources/gains.txt", "0.25\n")
        tool = zipfile.ZipInfo("resources/tool.sh")
        tool.external_attr = 0o100755 << 16
        archive.writestr(tool, "#!/bin/sh\n")
    out.with_suffix(".toml").write_text(experiment(out))


if __name__ == "__main__":
    main()
