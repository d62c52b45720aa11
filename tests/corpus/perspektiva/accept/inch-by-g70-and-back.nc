%CORPUS
(GOST 20999-83: G70 inches, G71 millimetres; on other controls G70 to G72 are turning cycles, and tools take them for such)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G70
G0 X1. Y1. Z2.5
G1 Z2. F10.
X3.
G71
X90. Y60.
Z45. F200.
G0 Z60.
M30
%
