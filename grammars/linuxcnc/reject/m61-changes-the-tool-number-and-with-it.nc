(expect VP0208: changes the tool's number and with it the length that G43 takes)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
M61
M2
