(expect VP0206: an arc of micrometres ends in its centre, which the tolerance of the radii would take)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G1 Z50. F200.
G3 X10.008 Y10. I0.008 J0.
G0 Z60.
M2
