(expect VP0208: taps rigidly, in step with the spindle)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G33.1 Z40. K1.
M2
