: shown to the operator, X10 Y10 is no motion here
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G1 Z50. F200.
  : and here
X20.
M30
