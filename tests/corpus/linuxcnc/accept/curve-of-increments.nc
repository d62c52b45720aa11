(control points under G91 count from the start of the curve; an even order 4, a corner by two points on each other)
G17 G21 G40 G49 G54 G80 G90
G0 X10 Y10 Z60
G1 Z50 F200
G91
G5.2 P1 L4
X0 Y0 P1
X0 Y20 P1
X20 Y20 P1
X20 Y20 P1
X20 Y0 P3
G5.3
G1 X5
G90
G0 Z60
M2
