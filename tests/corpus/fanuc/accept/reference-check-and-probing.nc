%
O0001
(G27, G30.1 and G31 move by rules of the control: never corrected, position unknown afterwards; levellers shifted the probe's target)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G27 X0 Y0
G0 X10. Y10. Z60.
G30.1 Z60.
G0 X10. Y10. Z60.
G31 Z40. F50.
G0 X10. Y10. Z60.
G31.1 X20. F50.
G31.2 Y20. F50.
G31.3 Z40. F50.
G0 X10. Y10. Z60.
G1 Z50. F200.
X40.
G0 Z60.
M30
%
