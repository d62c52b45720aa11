(M98 P100 L3 calls O100 of the same file; #1 is set by the program)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
#1=2.5
G1 Z[52.5-#1] F200.
M98 P100 L3
G90
G0 Z60.
M30
O100
G91
G1 X[#1*4] Y#1
Y-#1
G90
M99
