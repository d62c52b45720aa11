"""What judges do alike and what decides nothing: the command line, the command that is run, folders that are kept,
cases in order, LinuxCNC's interpreter as a program, profiles of machines as data, numbers of words, self-tests.

Kinematics, what a program means, where a path lies beside another and what chance allows are each judge's own: two
judges that share such a thing are one judge. docs/testing.md says who shares what all the same. Python's standard
library only.
"""

import os

# Judges run cases side by side, and their matrices are small. To be set before numpy is imported.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
