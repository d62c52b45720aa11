%
O0001
(a drilling cycle in a rotated frame: hole by hole)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G68 X0 Y0 R15.
G99 G81 X20. Y20. Z30. R55. F100.
X80.
G91 X50. K3
G90 G98 X20. Y90.
G80
G69
G0 Z60.
M30
%
