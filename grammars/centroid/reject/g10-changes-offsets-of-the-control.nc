; expect VP0208: changes offsets of the control while the program runs
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G10 L2 P1 X5. Y5. Z5.
M30
