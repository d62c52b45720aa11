; the unit changes and changes back; a tool that reads the unit once scales the rest by 25.4
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G20
G0 X1. Y1. Z2.5
G1 Z2. F10.
X3.
G21
X90. Y60.
Z45. F200.
G0 Z60.
M30
