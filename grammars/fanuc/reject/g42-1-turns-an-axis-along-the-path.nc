%
O0001
(expect VP0208: turns an axis along the path)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G42.1 X20. F200.
M30
%
