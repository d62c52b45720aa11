"""Writes the generator's plain dictionary of a machine as a profile and its tables, for the command that is judged."""

from common.profile import Profile

from model import AXES

FACTORS = (1e3, 1e3, 1e3, 1e6, 1e6, 1e6)


def rounded(nodes, values):
    """A table as its file holds it, so that model and command read the same numbers."""
    return [round(float(q), 6) for q in nodes], [[round(v * f, 6) / f for v, f in zip(row, FACTORS)] for row in values]


def write(spec, folder):
    """Writes machine.toml and its tables into the folder; returns the path of the profile."""
    p = Profile("Judge", spec["control"], f"[{spec['chain']}]")
    p[""]["interpolation"] = "monotone" if spec["cubic"] else "linear"
    if "reference_c" in spec.get("at", {}):
        p[""]["calibrated"] = {"date": "2026-01-01", "temperature_c": spec["at"]["reference_c"]}
    for name, a in zip(AXES, spec["axes"]):
        p.axis(name).update(travel_mm=a["travel"], resolution_mm=a["resolution"], backlash_um=a.get("backlash_um") or None)
        for key in ("errors", "errors_negative"):
            if a.get(key):
                nodes, values = a[key]
                p.errors(name, nodes, [[v * f for v, f in zip(row, FACTORS)] for row in values], key, ".6f")
        if "measured_at" in a:
            p.axis(name)["measured_at_mm"] = {**{AXES[j]: v for j, v in a["measured_at"].items()}, "tool": a["measured_tool"]}
    if any(spec.get("squareness_urad", ())):
        p["squareness"].update(zip(("EC0Y_urad", "EB0Z_urad", "EA0Z_urad"), spec["squareness_urad"]))
    p["tool"].update(default_mm=spec["tool"], lengths_mm=spec.get("lengths") or None)
    p["work_offsets_mm"]["G54"], p["correction"]["tolerance_um"] = spec["offset"], spec["tolerance_um"]
    p.effects += spec.get("effects", [])
    return str(p.write(folder, "machine.toml"))


def conditions(spec):
    """--at for the command line, where effects need it."""
    at = {k: v for k, v in spec.get("at", {}).items() if k != "reference_c"}
    return ["--at", ",".join(f"{k}={v}" for k, v in at.items())] if at else []
