%
O0001
(G92 makes a frame of where the axes stand: with corrected axes it must say so, or the correction moves into the frame)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G1 Z50. F200.
X500. Y300.
G92 X0 Y0
X100. Y50.
X-300. Y-200. Z45.
G92 X10. Z0
X60. Z5.
G92.1 X0 Y0 Z0
G0 X250. Y150. Z50.
G1 X20. Y20.
G0 Z60.
M30
%
