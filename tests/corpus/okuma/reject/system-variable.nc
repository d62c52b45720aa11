O2 (expect VP0120: the machine alone knows it)
G15 H1
G0 G17 G21 G40 G53 G80 G90 X10. Y10. Z60.
G1 X=VZOFZ[1] F200.
M2
