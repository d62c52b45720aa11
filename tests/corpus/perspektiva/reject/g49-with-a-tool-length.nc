%CORPUS
(expect VP0215: adds an offset after GOST 20999-83, ends the length elsewhere)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G43 H1 Z60.
G1 Z50. F200.
G49
X20.
M30
%
