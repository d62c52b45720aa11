"""Correction of NC programs for machine tools as they were measured.

What the command ``vpost`` does, on texts and arrays: the same bytes, the same digits, the same refusals.

Lengths are millimetres, errors micrometres, angles of axes degrees; the name of each array says its unit.
"""

from ._calibration import Calibration, calibrate
from ._diagnosis import Cause, Change, Diagnosis, Gap, Parameter, diagnose
from ._messages import Error, Message, NotFiniteError, Refused, ShapeError, UnitsError
from ._points import Budget, ErrorMap, Predicted, Solved, budget, map, predict, solve
from ._programs import Checked, Corrected, check, correct

__all__ = [
    "Budget",
    "Calibration",
    "Cause",
    "Change",
    "Checked",
    "Corrected",
    "Diagnosis",
    "Error",
    "ErrorMap",
    "Gap",
    "Message",
    "NotFiniteError",
    "Parameter",
    "Predicted",
    "Refused",
    "ShapeError",
    "Solved",
    "UnitsError",
    "budget",
    "calibrate",
    "check",
    "correct",
    "diagnose",
    "map",
    "predict",
    "solve",
]
