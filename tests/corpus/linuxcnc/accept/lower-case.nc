(letters of either case)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
g1 z50. f200.
x20. y20.
g2 i5. j0.
M2
