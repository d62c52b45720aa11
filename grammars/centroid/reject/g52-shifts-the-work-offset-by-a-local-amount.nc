; expect VP0208: shifts the work offset by a local amount
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G52 X10.
M30
