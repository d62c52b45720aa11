%CORPUS
(G1 with F and no axis moves nothing; a leveller stopped at it with missing data, as Universal Gcode Sender's did)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G1 F200.
Z50.
F300.
X40.
G0 Z60.
M30
%
