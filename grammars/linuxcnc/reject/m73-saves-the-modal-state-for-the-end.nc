(expect VP0208: saves the modal state for the end of a subprogram)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
M73
M2
