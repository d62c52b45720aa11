(centre words from the start, a radius, a helix, a full circle)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G1 Z50. F200.
G2 X30. Y10. I10. J0.
G3 X50. R-12.
G2 I-5.25
X50. Y10. I5. Z45.
G18
G2 X70. Z45. I10. K0.
G17
G19
G3 Y30. Z45. J10. K0.
G17
M30
