O2 (expect VP0120: DIA lives nobody says how long)
G15 H1
G0 G17 G21 G40 G53 G80 G90 X10. Y10. Z60.
DIA=10.
G1 X=DIA F200.
M2
