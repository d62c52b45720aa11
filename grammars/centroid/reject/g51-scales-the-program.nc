; expect VP0208: scales the program
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G51 X0 Y0 P2.
M30
