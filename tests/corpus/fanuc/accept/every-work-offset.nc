%
O0001
(each offset is another place of the machine, with other errors; a map in program coordinates is right for one of them)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G1 Z50. F200.
G55
G0 X10. Y20. Z60.
G1 Z50.
X60.
G0 Z60.
G56
G0 X11. Y20. Z60.
G1 Z50.
X60.
G0 Z60.
G58
G0 X12. Y20. Z60.
G1 Z50.
X60.
G0 Z60.
G59
G0 X13. Y20. Z60.
G1 Z50.
X60.
G0 Z60.
G54
G0 X14. Y20. Z60.
G1 Z50.
X60.
G0 Z60.
M30
%
