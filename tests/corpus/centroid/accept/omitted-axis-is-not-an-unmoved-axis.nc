; a Y alone may need X and Z after correction: autolevellers moved only what was written
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G1 Z50. F200.
X300.
Y400.
Z40.
M30
