(executed and expanded)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
o1 repeat [3]
G91 G1 X1. F200.
o1 endrepeat
M2
