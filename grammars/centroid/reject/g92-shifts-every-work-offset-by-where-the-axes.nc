; expect VP0208: shifts every work offset by where the axes stand
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G92 X0
M30
