(Z before X and Y are known: levellers started from zero, or from where the machine stood, and dived)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G0 Z20.
X0 Y0
Z1.
G1 X10. F100.
Y2.
X0
G0 Z5.
M2
