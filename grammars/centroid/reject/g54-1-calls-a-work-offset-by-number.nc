; expect VP0208: calls a work offset by number (P)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G54.1 P1
M30
