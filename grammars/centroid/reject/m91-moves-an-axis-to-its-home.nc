; expect VP0208: moves an axis to its home
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
M91 X
M30
