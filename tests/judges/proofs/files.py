"""Writes the generator's plain dictionary of a machine as a profile and its tables, for the command that is judged."""

import os

from model import AXES

FACTORS = (1e3, 1e3, 1e3, 1e6, 1e6, 1e6)


def table_text(i, nodes, values):
    """CSV of one table: values in mm and rad in the dictionary, micrometres and microradians in the file."""
    head = ["position_mm"] + [f"E{c}{AXES[i]}_{'um' if k < 3 else 'urad'}" for k, c in enumerate("XYZABC")]
    rows = [",".join(head)]
    for q, row in zip(nodes, values):
        rows.append(",".join([f"{q:.6f}"] + [f"{v * f:.6f}" for v, f in zip(row, FACTORS)]))
    return "\n".join(rows) + "\n"


def rounded(nodes, values):
    """A table as its file holds it, so that model and command read the same numbers."""
    return [round(float(q), 6) for q in nodes], [[round(v * f, 6) / f for v, f in zip(row, FACTORS)] for row in values]


def write(spec, folder):
    """Writes machine.toml and its tables into the folder; returns the path of the profile."""
    lines = ["format = 1", 'name = "Judge"', f'control = "{spec["control"]}"', f'chain = "[{spec["chain"]}]"']
    lines.append(f'interpolation = "{"monotone" if spec["cubic"] else "linear"}"')
    if "reference_c" in spec.get("at", {}):
        lines.append(f'calibrated = {{ date = "2026-01-01", temperature_c = {spec["at"]["reference_c"]} }}')
    for i, name in enumerate(AXES):
        a = spec["axes"][i]
        lines += [f"[axis.{name}]", f"travel_mm = {list(a['travel'])}", f"resolution_mm = {a['resolution']}"]
        for key in ("errors", "errors_negative"):
            if a.get(key):
                file = f"{name.lower()}_{key}.csv"
                with open(os.path.join(folder, file), "w", encoding="ascii") as out:
                    out.write(table_text(i, *a[key]))
                lines.append(f'{key} = "{file}"')
        if a.get("backlash_um"):
            lines.append(f"backlash_um = {a['backlash_um']}")
        if "measured_at" in a:
            at = ", ".join([f"{AXES[j]} = {v}" for j, v in a["measured_at"].items()] + [f"tool = {list(a['measured_tool'])}"])
            lines.append(f"measured_at_mm = {{ {at} }}")
    if any(spec.get("squareness_urad", ())):
        names = ("EC0Y_urad", "EB0Z_urad", "EA0Z_urad")
        lines += ["[squareness]"] + [f"{n} = {v}" for n, v in zip(names, spec["squareness_urad"])]
    lines += ["[tool]", f"default_mm = {list(spec['tool'])}"]
    if spec.get("lengths"):
        lines.append("lengths_mm = { " + ", ".join(f"{k} = {v}" for k, v in spec["lengths"].items()) + " }")
    lines += ["[work_offsets_mm]", f"G54 = {list(spec['offset'])}"]
    lines += ["[correction]", f"tolerance_um = {spec['tolerance_um']}"]
    for effect in spec.get("effects", []):
        lines.append("[[effect]]")
        lines += [f'{k} = "{v}"' if isinstance(v, str) else f"{k} = {v}" for k, v in effect.items()]
    path = os.path.join(folder, "machine.toml")
    with open(path, "w", encoding="ascii") as out:
        out.write("\n".join(lines) + "\n")
    return path


def conditions(spec):
    """--at for the command line, where effects need it."""
    at = {k: v for k, v in spec.get("at", {}).items() if k != "reference_c"}
    return ["--at", ",".join(f"{k}={v}" for k, v in at.items())] if at else []
