; expect VP0208: moves an axis until a switch opens
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
M106 X P5 F100.
M30
