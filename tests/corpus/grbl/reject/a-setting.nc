(expect VP0105: a setting changes the machine)
$110=500
G21 G90 G17
G0 X10 Y10 Z60
G1 X40 F200
M2
