(F under G95 is mm per turn and stays as it is when a block is split; a tool that recomputes F for each piece changes the chip)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
M3 S800
G1 Z50. F200.
G95 F0.2
X200. Y150.
G94 F200.
X20. Y20.
G93 X30. F4.
G94 X40. F200.
G0 Z60.
M2
