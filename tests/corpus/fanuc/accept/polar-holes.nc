%
O0001
(G16 makes X and Y radius and angle: a bolt circle, the radius held; levellers looked up X as a place)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G17 G90 G16
G98 G81 X50. Y30. Z30. R55. F100.
Y150.
Y270.
G15 G80
G0 X10. Y10.
M30
%
