%CORPUS
(expect VP0208: returns from a subprogram: the state it runs in is the caller's)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
M99
M30
%
