(expect VP0208: roughs a turned contour by a cycle of the control)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G72.2 P1000 L4 I20. J0
M2
