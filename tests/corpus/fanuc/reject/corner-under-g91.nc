%
O0001
(expect VP0142: increments that depend on the next block)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G1 Z50. F200.
G91 X40. ,R5.
Y40.
G90
M30
%
