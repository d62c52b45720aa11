(G38.2 to G38.5 stop where they touch: never corrected, position unknown afterwards; levellers shifted the probe's target)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G38.2 Z40. F50.
G0 X10. Y10. Z60.
G38.3 Z40. F50.
G0 X10. Y10. Z60.
G38.4 Z65. F50.
G0 X10. Y10. Z60.
G38.5 Z65. F50.
G0 X10. Y10. Z60.
G1 Z50. F200.
X40.
G0 Z60.
M2
