%
O0001
(flow is executed first, then corners are written out)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
#1=5.
G1 Z50. F200.
X[40+#1] ,R#1
Y40.
G0 Z60.
M30
%
