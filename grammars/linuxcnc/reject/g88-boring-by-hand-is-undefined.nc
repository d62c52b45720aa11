(expect VP0208: the interpreter takes it, its reference calls it undefined, and the operator retracts)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
M3 S500
G98 G88 X20. Y20. Z45. R50. P1 F100.
M2
