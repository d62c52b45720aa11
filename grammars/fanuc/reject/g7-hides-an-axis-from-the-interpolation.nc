%
O0001
(expect VP0208: hides an axis from the interpolation)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G7 Y0
M30
%
