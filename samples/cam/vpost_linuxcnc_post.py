"""FreeCAD's post for LinuxCNC, and vpost behind it: what is written is corrected for the machine, or nothing is."""
import subprocess

try:
    from Path.Post.scripts import linuxcnc_post as posted_by  # FreeCAD 0.21 and newer
except ImportError:
    from PathScripts.post import linuxcnc_post as posted_by  # FreeCAD 0.19, 0.20

VPOST = ["vpost", "-", "-m", "/etc/vpost/my-machine.toml", "--dialect", "linuxcnc"]
TOOLTIP, TOOLTIP_ARGS = __doc__, posted_by.TOOLTIP_ARGS


def export(objects, filename, arguments):
    posted = posted_by.export(objects, "-", arguments + " --no-show-editor")
    ran = subprocess.run(VPOST, input=posted.encode(), stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    if ran.returncode != 0:
        raise RuntimeError(ran.stderr.decode())  # FreeCAD shows it; no file is written
    if filename != "-":
        with open(filename, "wb") as corrected:
            corrected.write(ran.stdout)
    return ran.stdout.decode()
