%
O0001
(expect VP0208: G29 returns through the point of an earlier G28)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G28 Z60.
G29 Z50.
G0 Z60.
M30
%
