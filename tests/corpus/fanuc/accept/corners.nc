%
O0001
(a rounding and a chamfer between lines, one behind the other, left and right, sharp and blunt: written out as arcs and lines, then corrected; readers take ,R for R)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G1 Z50. F200.
X60. ,R5.
Y40. ,C4.
X20. Y60. ,R3.
(remark)
X10. Y20. ,R2.5
X30. ,R4.
Y5.
G0 Z60.
M30
%
