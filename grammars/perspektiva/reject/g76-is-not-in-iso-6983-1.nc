%CORPUS
(expect VP0208: is not in ISO 6983-1: what it does here is not published)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G76 P1 Z-10. I-0.1 J0.05 K0.3 F1.
M30
%
