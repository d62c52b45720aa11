%
O01105 (behind a pallet or tool change the axes stand anywhere until they are named)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G1 Z50. F200.
G0 Z60.
M50
G0 X20. Y20. Z60.
G1 Z50.
G0 Z60.
M36
G0 X25. Y20. Z60.
G1 Z50.
G0 Z60.
T2 M16
G0 X30. Y20. Z60.
G1 Z50.
G0 Z60.
M30
%
