(expect VP0208: chooses the plane of W and U)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G18.1
M2
