(RS274/NGC: in an inch program the ends of an arc may differ by 0.0002 inch)
G20 G90 G17 G54
G0 X21.5179 Y8.2 Z1.
G1 Z0. F50.
G3 X19.6618 I-0.928 J0.
M2
