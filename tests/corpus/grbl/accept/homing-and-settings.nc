(homing, settings, and a first motion without its code: the control starts in G0)
$32=1
$X
$H
G21 G90 G17
X10 Y10 Z60
G1 Z50 F200
X90 Y40
G28.2 X0 Y0
G0 X15 Y15
G1 X40
M777
M2
