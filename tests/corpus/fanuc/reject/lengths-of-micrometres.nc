%
O0001
(expect VP0242: X40 of a post for another control would be 0.040 mm here)
G17 G21 G40 G49 G54 G80 G90
G0 X10 Y10 Z60
G1 Z50 F200
X40 Y30
M30
%
