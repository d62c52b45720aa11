(expect VP0208: cuts a quadratic spline)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G5.1 X20. Y20. I5. J0 F200.
M2
